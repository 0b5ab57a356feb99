// Any bytes as a scene file of glint's: it is read and checked, or refused. What passes the check can be looked at: every
// pixel of a small picture sees nothing or a point on a surface.
#include <cmath>
#include <stdexcept>

#include <scene.hpp>
#include <scene_file.hpp>

#include <mica/grid/grid_vertices.hpp>

#include "file_in_memory.hpp"
#include "input.hpp"

namespace {

void look_at(const glint::scene_description& description) {
    constexpr std::size_t width = 5, height = 4;
    const glint::scene seen(description.camera, description.surfaces, width, height);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const auto hit = seen.surface(x, y);
            if (!hit) continue;
            require(hit->surface < description.surfaces.size(), "what is seen is a surface of the scene");
            const auto pixel = mica::make_footprint(hit->point.derivatives);
            require(std::isfinite(pixel.area), "a footprint is finite", static_cast<double>(pixel.area));
        }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const file_in_memory file(data, size);
    try {
        const auto description = glint::read_scene(file.path());
        check(description);
        look_at(description);
    } catch (const std::runtime_error&) { // it says what is wrong; main() makes one line of it
    } catch (const std::invalid_argument&) {
    }
    return 0;
}
