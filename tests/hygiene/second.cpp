// tests/hygiene/second.cpp: all of mica once more, with the macros of Windows before it.
#include "windows.hpp"

#include "surface.hpp"

drawn::brightness drawn::under_the_sun_in_second_unit(std::uint32_t seed) { return surface::under_the_sun(seed); }
