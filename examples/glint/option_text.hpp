// Options that are more than a number or a name.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "description.hpp"
#include "picture.hpp"

namespace glint {

/// "WxH". Throws std::invalid_argument, in one line, where it is not.
std::pair<std::size_t, std::size_t> parse_size(const std::string& text);

/// "x,y,z". Throws as parse_size does.
vector parse_vector(const std::string& text);

/// "x,y,w,h" within a picture, or empty: all of it. Throws as parse_size does.
pixel_rectangle parse_tile(const std::string& text, std::size_t width, std::size_t height);

} // namespace glint
