// Any text as an option of glint's: it is what it looks like, or refused.
#include <algorithm>
#include <stdexcept>

#include <option_text.hpp>

#include "input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text = input(data, size).rest();
    try {
        const auto [width, height] = glint::parse_size(text);
        require(glint::parse_size(std::to_string(width) + "x" + std::to_string(height)) == std::pair(width, height),
                "a size is read again");
    } catch (const std::invalid_argument&) { // it says what is wrong; main() makes one line of it
    }
    try {
        glint::parse_vector(text);
        require(std::count(text.begin(), text.end(), ',') == 2, "a vector has two commas");
    } catch (const std::invalid_argument&) {
    }
    try {
        const auto tile = glint::parse_tile(text, 40, 30);
        require(tile.area() > 0 && tile.left + tile.width <= 40 && tile.top + tile.height <= 30,
                "a tile is in its picture");
    } catch (const std::invalid_argument&) {
    }
    glint::is_built_in(text);
    return 0;
}
