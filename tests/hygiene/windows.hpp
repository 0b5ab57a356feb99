// tests/hygiene/windows.hpp: the macros of <windows.h> that collide with names, defined before mica is included. The
// standard headers come first: those of Windows are written around the macros, others undefine them.
#pragma once

#include "standard_headers.hpp" // all that mica includes, written by tests/hygiene/run

#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define near
#define far
#define IN
#define OUT
#define OPTIONAL
#define small char
#define hyper long long
#define interface struct
#define ERROR 0
#define TRUE 1
#define FALSE 0
#define NO_ERROR 0
#define STRICT 1
#define DELETE 1
#define ABSOLUTE 1
#define RELATIVE 2
#define OPAQUE 2
#define TRANSPARENT 1
