// What the shared library shows: the declarations of the public headers, and nothing else.
#pragma once

#if defined(_WIN32)
#define PSK_EXPORT
#define PSK_HIDDEN
#else
#define PSK_EXPORT __attribute__((visibility("default")))
#define PSK_HIDDEN __attribute__((visibility("hidden")))
#endif
