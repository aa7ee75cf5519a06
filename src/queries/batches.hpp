// Many questions, divided among threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <kerf/batch.hpp>

#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "traversal/rays/batch.hpp"

namespace kerf {

/// How many questions about points or boxes a task answers: each takes a microsecond and more.
inline constexpr std::size_t points_per_batch = 64;

/// Throws `Error::invalid_argument` unless there is room for an answer to each question.
inline void require_as_many(std::size_t questions, std::size_t answers, const char* what) {
  if (questions != answers) raise(Error::invalid_argument, "%s", what);
}

/// Calls `answer(begin, count)` for batches of at most `per_batch` that together are `0 .. count - 1`, on as
/// many threads as the options say.
template <class Answer>
void for_each_batch(std::size_t count, std::size_t per_batch, const BatchOptions& options,
                    const Answer& answer) {
  const auto answer_range = [&](std::size_t begin, std::size_t end) {
    for (; begin < end; begin += per_batch) answer(begin, std::min(per_batch, end - begin));
  };
  if (count <= per_batch) {
    const PlainFloatingPoint plain;
    answer_range(0, count);
    return;
  }
  report_out_of_memory([&] {
    on_threads(options.threads, [&] {
      parallel_for_ranges(std::size_t{0}, count, per_batch,
                          [&](const auto& range) { answer_range(range.begin(), range.end()); });
    });
  });
}

/// Lists of answers, made batch by batch and then put one behind the other. `append(i, items)` appends list i
/// to `items`.
template <class T, class Append>
Lists<T> list_in_batches(std::size_t count, std::size_t per_batch, const BatchOptions& options,
                         const Append& append) {
  return report_out_of_memory([&] {
    Lists<T> lists;
    lists.offsets.assign(count + 1, 0);
    std::vector<std::vector<T>> parts((count + per_batch - 1) / per_batch);
    // A batch begins at a multiple of `per_batch` however threads divide the batches.
    for_each_batch(parts.size(), 1, options, [&](std::size_t part, std::size_t) {
      const std::size_t begin = part * per_batch, end = std::min(count, begin + per_batch);
      for (std::size_t i = begin; i < end; ++i) {
        append(i, parts[part]);
        lists.offsets[i + 1] = parts[part].size();
      }
    });
    std::vector<std::size_t> before(parts.size() + 1, 0);
    for (std::size_t part = 0; part < parts.size(); ++part)
      before[part + 1] = before[part] + parts[part].size();
    lists.items.resize(before.back());
    for_each_batch(parts.size(), 1, options, [&](std::size_t part, std::size_t) {
      const std::size_t begin = part * per_batch, end = std::min(count, begin + per_batch);
      for (std::size_t i = begin; i < end; ++i) lists.offsets[i + 1] += before[part];
      std::copy(parts[part].begin(), parts[part].end(),
                lists.items.begin() + static_cast<std::ptrdiff_t>(before[part]));
    });
    return lists;
  });
}

}  // namespace kerf
