#include "frame_file.hpp"

#include <array>
#include <exception>

#include <ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

namespace glint {

namespace {

constexpr const char* origin_attribute = "glint";
constexpr int widest_picture = 16384; ///< pixels, either way

/// More are not in a file: deflate makes 28 bytes of ours a thousandth at best, and no map is as even as that.
constexpr std::uintmax_t most_pixels_per_byte = 64, most_texels_per_byte = 128;

struct channel {
    const char* name;
    float* first;
};

std::array<channel, 3> channels_of(std::vector<mica::rgb<float>>& pixels, const std::array<const char*, 3>& names) {
    auto& first = pixels.front();
    return {{{names[0], &first.r}, {names[1], &first.g}, {names[2], &first.b}}};
}
constexpr std::array<const char*, 3> of_glint{"R", "G", "B"}, of_smooth{"smooth.R", "smooth.G", "smooth.B"};

/// Values `stride` floats apart, row by row of the window.
Imf::Slice slice(float* first, std::size_t stride, const Imath::Box2i& window) {
    const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x) + 1;
    return Imf::Slice::Make(Imf::FLOAT, first, window, stride * sizeof(float), stride * width * sizeof(float));
}

void add(Imf::FrameBuffer& buffer, const std::array<channel, 3>& channels, const Imath::Box2i& window) {
    for (const auto& each : channels) buffer.insert(each.name, slice(each.first, 3, window));
}

Imath::Box2i box(const pixel_rectangle& tile) {
    const auto x = static_cast<int>(tile.left), y = static_cast<int>(tile.top);
    return {{x, y}, {x + static_cast<int>(tile.width) - 1, y + static_cast<int>(tile.height) - 1}};
}

/// At most so many pixels either way, and not so far out that sums overflow.
bool is_reasonable(const Imath::Box2i& window, int widest) {
    const auto in_range = [widest](int low, int high) {
        constexpr int far_out = 1 << 24;
        return low > -far_out && high < far_out && low <= high && high - low < widest;
    };
    return in_range(window.min.x, window.max.x) && in_range(window.min.y, window.max.y);
}

std::size_t length(int low, int high) { return static_cast<std::size_t>(high - low) + 1; }

/// Calls read() and turns what OpenEXR throws into one line about the file.
template <class Read>
auto reading(const std::string& path, const Read& read) {
    try {
        return read();
    } catch (const std::exception& error) {
        const std::string what = error.what();
        throw what.starts_with(path + ": ") ? std::runtime_error(what)
                                            : file_error(path, "cannot be read as OpenEXR: " + what);
    }
}

void require(const std::string& path, const Imf::Header& header, const std::array<const char*, 3>& names) {
    for (const char* const name : names)
        if (header.channels().findChannel(name) == nullptr)
            throw file_error(path, std::string("has no channel ") + name);
}

void write_exr(const std::string& path, const frame& seen, const std::string& origin) {
    const Imath::Box2i window = box(seen.tile);
    Imf::Header header(box({0, 0, seen.width, seen.height}), window);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.insert(origin_attribute, Imf::StringAttribute(origin));
    for (const auto& names : {of_glint, of_smooth})
        for (const char* const name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    header.channels().insert("A", Imf::Channel(Imf::FLOAT));

    auto glint = seen.glint.pixels, smooth = seen.smooth.pixels; // OpenEXR reads through pointers to what may change
    std::vector<float> alpha(seen.shows_surface.begin(), seen.shows_surface.end());
    Imf::FrameBuffer buffer;
    add(buffer, channels_of(glint, of_glint), window);
    add(buffer, channels_of(smooth, of_smooth), window);
    buffer.insert("A", slice(alpha.data(), 1, window));
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(window.max.y - window.min.y + 1);
}

} // namespace

mica::environment_map read_exr_environment(const std::string& path) {
    const std::uintmax_t bytes = size_of_plain_file(path);
    return reading(path, [&] {
        Imf::InputFile file(path.c_str());
        const Imath::Box2i window = file.header().dataWindow();
        if (!is_reasonable(window, widest_map))
            throw file_error(path, "is too large: at most " + std::to_string(widest_map) + " wide is read");
        const std::size_t width = length(window.min.x, window.max.x), height = length(window.min.y, window.max.y);
        if (width != 2 * height)
            throw file_error(path, "is not an environment map: " + std::to_string(width) + "x" +
                                       std::to_string(height) + " is not twice as wide as high");
        require(path, file.header(), of_glint);
        if (width * height > most_texels_per_byte * bytes) throw file_error(path, "is truncated");
        std::vector<mica::rgb<float>> texels(width * height);
        Imf::FrameBuffer buffer;
        add(buffer, channels_of(texels, of_glint), window);
        file.setFrameBuffer(buffer);
        file.readPixels(window.min.y, window.max.y);
        return mica::environment_map(width, height, std::move(texels));
    });
}

frame_file::frame_file(const std::string& path) {
    if (path.ends_with(".exr"))
        exr_.emplace(path);
    else
        png_.emplace(path);
}

void frame_file::save(const frame& seen, const frame_statistics& statistics, const std::string& origin) const {
    if (exr_) exr_->save([&](const std::string& name) { write_exr(name, seen, origin); });
    if (!png_) return;
    srgb_picture picture(seen.width, seen.height, 0);
    tone_map(seen.glint, exposure_of(statistics), picture, 0, 0);
    png_->save(picture);
}

frame_of_file read_frame(const std::string& path) {
    const std::uintmax_t bytes = size_of_plain_file(path);
    return reading(path, [&] {
        Imf::InputFile file(path.c_str());
        const auto* const origin = file.header().findTypedAttribute<Imf::StringAttribute>(origin_attribute);
        if (origin == nullptr) throw file_error(path, "is not a picture that glint rendered");
        require(path, file.header(), of_glint);
        require(path, file.header(), of_smooth);
        const Imath::Box2i whole = file.header().displayWindow(), window = file.header().dataWindow();
        if (!is_reasonable(whole, widest_picture) || !is_reasonable(window, widest_picture) || window.min.x < 0 ||
            window.min.y < 0 || whole.min.x != 0 || whole.min.y != 0 || window.max.x > whole.max.x ||
            window.max.y > whole.max.y)
            throw file_error(path, "is not a tile of its picture");
        if (length(window.min.x, window.max.x) * length(window.min.y, window.max.y) > most_pixels_per_byte * bytes)
            throw file_error(path, "is truncated");
        const pixel_rectangle tile{static_cast<std::size_t>(window.min.x), static_cast<std::size_t>(window.min.y),
                                   length(window.min.x, window.max.x), length(window.min.y, window.max.y)};
        frame_of_file result{frame(length(0, whole.max.x), length(0, whole.max.y), tile), origin->value()};
        std::vector<float> alpha(tile.area());
        Imf::FrameBuffer buffer;
        add(buffer, channels_of(result.seen.glint.pixels, of_glint), window);
        add(buffer, channels_of(result.seen.smooth.pixels, of_smooth), window);
        buffer.insert("A", slice(alpha.data(), 1, window));
        file.setFrameBuffer(buffer);
        file.readPixels(window.min.y, window.max.y);
        for (std::size_t i = 0; i < alpha.size(); ++i) result.seen.shows_surface[i] = alpha[i] > 0;
        return result;
    });
}

} // namespace glint
