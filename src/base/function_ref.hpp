// A callable by reference.
#pragma once

#include <utility>

namespace kerf {

template <class Signature>
class FunctionRef;

/// What takes one is compiled once for all callables. The callable must outlive it.
template <class Result, class... Parameters>
class FunctionRef<Result(Parameters...)> {
 public:
  template <class Function>
  FunctionRef(const Function& function)
      : context_(&function), call_([](const void* context, Parameters... parameters) -> Result {
          return (*static_cast<const Function*>(context))(std::forward<Parameters>(parameters)...);
        }) {}

  Result operator()(Parameters... parameters) const {
    return call_(context_, std::forward<Parameters>(parameters)...);
  }

 private:
  const void* context_;
  Result (*call_)(const void*, Parameters...);
};

}  // namespace kerf
