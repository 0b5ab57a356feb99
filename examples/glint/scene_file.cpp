#include "scene_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace glint {

namespace {

using nlohmann::json;

/// The fields of a JSON object, each read at most once into what has its default; done() finds those that nobody asked for.
class fields {
  public:
    fields(const json& object, std::string place) : object_(object), place_(std::move(place)) {
        if (!object.is_object()) throw std::invalid_argument(place_ + " is not an object");
    }

    template <class Value>
    void read(const char* name, Value& value) {
        if (const json* found = find(name)) set(*found, place_ + "." + name, value);
    }

    /// Degrees in the file, radians in the scene.
    void read_degrees(const char* name, float& radians) {
        std::optional<float> degrees;
        read(name, degrees);
        if (degrees) radians = *degrees / degrees_per_radian;
    }

    /// An array: read_one(element, its place) for each.
    template <class Value, class Read>
    void read_all(const char* name, std::vector<Value>& values, const Read& read_one) {
        const json* const found = find(name);
        if (!found) return;
        if (!found->is_array()) throw std::invalid_argument(place_ + "." + name + " is not an array");
        values.clear();
        for (std::size_t i = 0; i < found->size(); ++i)
            values.push_back(read_one((*found)[i], place_ + "." + name + "[" + std::to_string(i) + "]"));
    }

    /// Calls body(object, its place) where there is one.
    template <class Body>
    void within(const char* name, const Body& body) {
        if (const json* found = find(name)) body(*found, place_ + "." + name);
    }

    void done() const {
        for (const auto& item : object_.items())
            if (!asked_.contains(item.key())) {
                std::string known;
                for (const auto& name : asked_) known += (known.empty() ? "" : ", ") + name;
                throw std::invalid_argument(place_ + " has an unknown field '" + item.key() + "' (known: " + known +
                                            ")");
            }
    }

  private:
    const json* find(const char* name) {
        asked_.insert(name);
        const auto found = object_.find(name);
        return found == object_.end() ? nullptr : &*found;
    }

    template <std::floating_point Value>
    static void set(const json& from, const std::string& place, Value& value) {
        if (!from.is_number()) throw std::invalid_argument(place + " is not a number");
        value = from.get<Value>();
    }
    static void set(const json& from, const std::string& place, bool& value) {
        if (!from.is_boolean()) throw std::invalid_argument(place + " is not true or false");
        value = from.get<bool>();
    }
    static void set(const json& from, const std::string& place, std::string& value) {
        if (!from.is_string()) throw std::invalid_argument(place + " is not a string");
        value = from.get<std::string>();
    }
    template <std::integral Value>
    static void set(const json& from, const std::string& place, Value& value) {
        constexpr auto most = std::min<std::uint64_t>(4294967295U, std::numeric_limits<Value>::max());
        if (!from.is_number_integer() || from.get<double>() < 0 || from.get<double>() > static_cast<double>(most))
            throw std::invalid_argument(place + " is not a whole number from 0 to " + std::to_string(most));
        value = from.get<Value>();
    }
    template <class Value, std::size_t Size>
    static void set(const json& from, const std::string& place, std::array<Value, Size>& values) {
        if (!from.is_array() || from.size() != Size)
            throw std::invalid_argument(place + " is not an array of " + std::to_string(Size) + " numbers");
        for (std::size_t i = 0; i < Size; ++i) set(from[i], place + "[" + std::to_string(i) + "]", values[i]);
    }
    static void set(const json& from, const std::string& place, vector& value) {
        std::array<float, 3> xyz;
        set(from, place, xyz);
        value = {xyz[0], xyz[1], xyz[2]};
    }
    template <class Value>
    static void set(const json& from, const std::string& place, std::optional<Value>& value) {
        set(from, place, value.emplace());
    }
    static void set(const json& from, const std::string& place, colour& value) {
        std::array<float, 3> bands;
        set(from, place, bands);
        value = {bands[0], bands[1], bands[2]};
    }

    const json& object_;
    std::string place_;
    std::set<std::string> asked_;
};

camera_description read_camera(const json& object, const std::string& place, camera_description camera) {
    fields from(object, place);
    from.read("eye", camera.eye);
    from.read("target", camera.target);
    from.read_degrees("field_of_view_degrees", camera.field_of_view);
    from.done();
    return camera;
}

surface_description read_surface(const json& object, const std::string& place) {
    surface_description surface;
    fields from(object, place);
    from.read("shape", surface.shape);
    from.read("centre", surface.centre);
    from.read("radius", surface.radius);
    from.read("roughness", surface.material.roughness);
    from.read("roughness_across", surface.roughness_across);
    from.read("log_density", surface.material.log_density);
    from.read("reflectance", surface.material.f0);
    from.read("glint_size", surface.material.footprint_scale);
    from.read("distribution", surface.distribution);
    from.done();
    return surface;
}

light_description read_light(const json& object, const std::string& place, const std::filesystem::path& folder) {
    light_description light;
    fields from(object, place);
    from.read("type", light.type);
    const bool environment = is_environment(light.type);
    if (environment) {
        from.read("file", light.file);
        from.read("levels", light.levels);
        from.read("classes", light.classes);
        if (!light.file.empty() && !is_built_in(light.file)) light.file = (folder / light.file).string();
    } else {
        from.read("radiance", light.radiance);
    }
    if (light.type == "wdh20") from.read("gamma", light.gamma);
    if (light.type == "directional" || light.type == "sun") from.read("direction", light.direction);
    if (light.type == "directional") from.read("glint_fraction", light.glint_fraction);
    if (light.type == "sun") from.read_degrees("half_angle_degrees", light.half_angle);
    if (light.type == "rectangle" || light.type == "area") {
        from.read("centre", light.centre);
        from.read("half_u", light.half_u);
        from.read("half_v", light.half_v);
    }
    if (light.type == "disk") {
        from.read("centre", light.centre);
        from.read("normal", light.normal);
        from.read("radius", light.radius);
    }
    from.done();
    return light;
}

scene_description read_fields(const json& object, const std::filesystem::path& folder) {
    scene_description scene;
    fields from(object, "scene");
    std::array<std::size_t, 2> size{scene.width, scene.height};
    from.read("size", size);
    std::tie(scene.width, scene.height) = std::pair{size[0], size[1]};
    from.read("seed", scene.seed);
    from.read_all("surfaces", scene.surfaces, read_surface);
    from.read_all("lights", scene.lights,
                  [&folder](const json& one, const std::string& place) { return read_light(one, place, folder); });
    if (!scene.surfaces.empty()) scene.camera = camera_for(scene.surfaces.front().shape);
    from.within("camera", [&](const json& one, const std::string& place) {
        scene.camera = read_camera(one, place, scene.camera);
    });
    from.read("occluder", scene.occluder);
    from.read("law", scene.counting.law);
    from.read("interpolate", scene.counting.interpolate);
    from.read("softness", scene.counting.softness);
    from.within("effects", [&](const json& one, const std::string& place) {
        auto& effects = scene.counting.effects;
        fields asked(one, place);
        asked.read("angular_grid", effects.angular_grid);
        asked.read("varied_density", effects.varied_density);
        asked.read("tint", effects.tint);
        asked.read("smooth_where_dense", effects.smooth_tolerance);
        asked.read("one_grid", effects.one_grid);
        asked.done();
    });
    from.done();
    return scene;
}

} // namespace

scene_description read_scene(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read");
    try {
        return read_fields(json::parse(file), std::filesystem::path(path).parent_path());
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw std::invalid_argument(path + ": " + error.what());
    }
}

} // namespace glint
