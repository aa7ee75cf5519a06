// What stands behind the handles of the public interface.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include <kerf/shared.hpp>

namespace kerf {

/// The pointer in a `Shared`. Who shares a T says `template class Shared<T>;` in one file.
template <class T>
struct SharedPointer {
  using Pointer = std::shared_ptr<const T>;

  static Pointer& in(Shared<T>& shared) {
    static_assert(sizeof(Pointer) == sizeof(shared.memory_) && alignof(Pointer) == alignof(Shared<T>));
    return *std::launder(reinterpret_cast<Pointer*>(shared.memory_));
  }
  static const Pointer& in(const Shared<T>& shared) {
    return *std::launder(reinterpret_cast<const Pointer*>(shared.memory_));
  }
  static Shared<T> share(Pointer pointer) {
    Shared<T> shared;
    in(shared) = std::move(pointer);
    return shared;
  }
  template <class... Arguments>
  static void make(Shared<T>& shared, Arguments&&... arguments) {
    ::new (static_cast<void*>(shared.memory_)) Pointer(std::forward<Arguments>(arguments)...);
  }
};

template <class T>
Shared<T>::Shared() noexcept {
  SharedPointer<T>::make(*this);
}
template <class T>
Shared<T>::Shared(const Shared& other) noexcept {
  SharedPointer<T>::make(*this, SharedPointer<T>::in(other));
}
template <class T>
Shared<T>::Shared(Shared&& other) noexcept {
  SharedPointer<T>::make(*this, std::move(SharedPointer<T>::in(other)));
}
template <class T>
Shared<T>& Shared<T>::operator=(const Shared& other) noexcept {
  SharedPointer<T>::in(*this) = SharedPointer<T>::in(other);
  return *this;
}
template <class T>
Shared<T>& Shared<T>::operator=(Shared&& other) noexcept {
  SharedPointer<T>::in(*this) = std::move(SharedPointer<T>::in(other));
  return *this;
}
template <class T>
Shared<T>::~Shared() {
  std::destroy_at(&SharedPointer<T>::in(*this));
}
template <class T>
const T* Shared<T>::get() const noexcept {
  return SharedPointer<T>::in(*this).get();
}

}  // namespace kerf
