// WEIR_ADDRESS_SANITIZER and WEIR_THREAD_SANITIZER are defined in builds with these, by GCC or by Clang.
#pragma once

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define WEIR_ADDRESS_SANITIZER
#endif
#if __has_feature(thread_sanitizer)
#define WEIR_THREAD_SANITIZER
#endif
#endif

#ifdef __SANITIZE_ADDRESS__
#define WEIR_ADDRESS_SANITIZER
#endif
#ifdef __SANITIZE_THREAD__
#define WEIR_THREAD_SANITIZER
#endif
