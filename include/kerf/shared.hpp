// How handles share what they stand for.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <kerf/export.hpp>

namespace kerf {

/// @cond  not for callers
/// A `std::shared_ptr<const T>` that only the library sees as one: <memory> takes longer to compile than all
/// headers of kerf together.
template <class T>
struct SharedPointer;
template <class T>
class KERF_API Shared {
 public:
  Shared() noexcept;
  Shared(const Shared& other) noexcept;
  Shared(Shared&& other) noexcept;
  Shared& operator=(const Shared& other) noexcept;
  Shared& operator=(Shared&& other) noexcept;
  ~Shared();

  const T* get() const noexcept;
  const T& operator*() const noexcept { return *get(); }
  const T* operator->() const noexcept { return get(); }

 private:
  friend struct SharedPointer<T>;

  alignas(void*) unsigned char memory_[2 * sizeof(void*)];
};
/// @endcond

}  // namespace kerf

#endif  // KERF_HAS_CPP20
