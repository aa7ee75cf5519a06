// The one exception type that kerf throws.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstddef>
#include <exception>
#include <string_view>

#include <kerf/export.hpp>

namespace kerf {

/// What went wrong, as a code to branch on and a sentence to show.
///
/// The object itself holds the sentence, so that an error can be made and copied when memory has run out.
class KERF_API Error : public std::exception {
 public:
  /// The kinds of errors.
  enum Code {
    invalid_argument,    ///< an option or a span that cannot be right
    non_finite_vertex,   ///< a vertex used by a triangle is not a number, infinite, or 2^126 and more
    index_out_of_range,  ///< a triangle names a vertex that does not exist
    too_large,           ///< more references than 32 bits can number
    out_of_memory,       ///< an allocation failed; everything allocated before has been freed
    cancelled,           ///< the progress callback asked to stop
    io,                  ///< a file cannot be opened, read, written or renamed
    bad_format,          ///< a file is not what its name or its header says
  };

  /// Keeps the first 511 bytes of `sentence`.
  Error(Code code, std::string_view sentence) noexcept : code_(code) {
    const std::size_t length =
        sentence.size() < sizeof(sentence_) - 1 ? sentence.size() : sizeof(sentence_) - 1;
    for (std::size_t i = 0; i < length; ++i) sentence_[i] = sentence[i];
    sentence_[length] = '\0';
  }

  Code code() const noexcept { return code_; }                      ///< which kind of error
  const char* what() const noexcept override { return sentence_; }  ///< the sentence

 private:
  Code code_;
  char sentence_[512];
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
