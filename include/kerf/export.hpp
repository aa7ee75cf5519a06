// What a shared library of kerf shows to its users; everything else in it is hidden.
#pragma once

#if defined(__GNUC__)
#define KERF_API __attribute__((visibility("default")))
#else
#define KERF_API
#endif
