#include "option_text.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

namespace glint {

std::pair<std::size_t, std::size_t> parse_size(const std::string& text) {
    std::size_t width = 0, height = 0;
    const char* const end = text.data() + text.size();
    const auto [cross, width_error] = std::from_chars(text.data(), end, width);
    const bool has_cross = width_error == std::errc() && cross != end && *cross == 'x';
    const auto [rest, height_error] = std::from_chars(has_cross ? cross + 1 : end, end, height);
    if (!has_cross || height_error != std::errc() || rest != end)
        throw std::invalid_argument("--size " + text + " is not WIDTHxHEIGHT");
    return {width, height};
}

vector parse_vector(const std::string& text) {
    const auto refused = [&text] { return std::invalid_argument("--occluder " + text + " is not x,y,z"); };
    const std::string closed = text + ","; // so that a comma follows every number
    const char* next = closed.data();
    const char* const end = next + closed.size();
    vector v{};
    for (float* const x : {&v.x, &v.y, &v.z}) {
        const auto [comma, error] = std::from_chars(next, end, *x);
        if (error != std::errc() || comma == end || *comma != ',') throw refused();
        next = comma + 1;
    }
    if (next != end) throw refused();
    return v;
}

pixel_rectangle parse_tile(const std::string& text, std::size_t width, std::size_t height) {
    if (text.empty()) return {0, 0, width, height};
    std::array<std::size_t, 4> number{};
    const std::string closed = text + ",";
    const char* next = closed.data();
    const char* const end = next + closed.size();
    for (std::size_t& x : number) {
        const auto [comma, error] = std::from_chars(next, end, x);
        if (error != std::errc() || comma == end || *comma != ',')
            throw std::invalid_argument("--tile " + text + " is not x,y,width,height");
        next = comma + 1;
    }
    if (next != end) throw std::invalid_argument("--tile " + text + " is not x,y,width,height");
    const auto [left, top, w, h] = number;
    if (w < 1 || h < 1 || left >= width || top >= height || w > width - left || h > height - top)
        throw std::invalid_argument("--tile " + text + " is not within " + std::to_string(width) + "x" +
                                    std::to_string(height));
    return {left, top, w, h};
}

} // namespace glint
