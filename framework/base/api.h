// What a shared library shows to others. Libraries are compiled with hidden visibility: they keep to
// themselves whatever is not marked.
#pragma once

/// Marks what other libraries may use. It opens the namespace of a whole header,
///
///   namespace WEIR_API weir {
///
/// stands before the name of a class, and before a function template whose instances a source makes, where
/// GCC forgets the namespace's. Headers have it that include/weir leads to, and those that our own programs,
/// plugins and tests include.
#define WEIR_API [[gnu::visibility("default")]]
