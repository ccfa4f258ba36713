// What a shared library shows to others. Libraries are compiled with hidden visibility, so they keep to themselves
// whatever is not marked.
#pragma once

/// Marks what other libraries may use. It opens the namespace of a whole header,
///
///   namespace WEIR_API weir {
///
/// and stands before the name of a class, or before a function template, which GCC needs where its instances are made
/// in a source. Headers have it that include/weir leads to, and those that our own programs, plugins and tests
/// include.
#define WEIR_API [[gnu::visibility("default")]]
