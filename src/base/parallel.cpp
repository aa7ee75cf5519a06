#include "base/parallel.hpp"

#include <algorithm>

#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#endif

namespace kerf {

int usable_threads(unsigned wanted) {
#if defined(KERF_SERIAL)
  unsigned available = 1;
#elif defined(KERF_STANDARD_THREADS)
  unsigned available = std::max(1u, std::thread::hardware_concurrency());
#else
  auto available =
      static_cast<unsigned>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
#endif
  if (const Team* const team = Team::current(); team != nullptr && team->pool() != nullptr)
    available = static_cast<unsigned>(team->threads());
  return static_cast<int>(wanted == 0 ? available : std::min(wanted, available));
}

namespace scheduler {
namespace {

// In the team of this thread, or in one for this call alone.
void in_team(FunctionRef<void(Team&)> work) {
  if (Team* const team = Team::current()) return work(*team);
  Team team(usable_threads(0));
  team.lead([&] { work(team); });
}

}  // namespace

void invoke(FunctionRef<void()> first, FunctionRef<void()> second) {
#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
  if (Team::current() == nullptr) return tbb::parallel_invoke(first, second);
#endif
  in_team([&](Team& team) { team.invoke(first, second); });
}

void loop(std::size_t begin, std::size_t end, std::size_t grain,
          FunctionRef<void(std::size_t, std::size_t)> body) {
#if !defined(KERF_STANDARD_THREADS) && !defined(KERF_SERIAL)
  if (Team::current() == nullptr) {
    using Range = tbb::blocked_range<std::size_t>;
    tbb::parallel_for(Range(begin, end, grain),
                      [&](const Range& range) { body(range.begin(), range.end()); });
    return;
  }
#endif
  in_team([&](Team& team) {
    team.loop(end - begin, grain, [&](std::size_t from, std::size_t to) { body(begin + from, begin + to); });
  });
}

void isolated(FunctionRef<void()> work) {
  if (one_thread_only || Team::current() != nullptr) return work();
#if defined(KERF_SERIAL) || defined(KERF_STANDARD_THREADS)
  Team team(usable_threads(0));
  team.lead(work);
#else
  tbb::this_task_arena::isolate(work);
#endif
}

void on_threads(unsigned wanted, FunctionRef<void()> work) {
  if (wanted == 0 || one_thread_only) return isolated(work);
  const int threads = usable_threads(wanted);
  if (threads == 1) return on_this_thread(work);
  if (Team* const team = Team::current(); team != nullptr && team->pool() != nullptr) {
    if (team->threads() == threads) return work();
    Team part(threads, team->pool());
    part.lead(work);
    return;
  }
#if defined(KERF_SERIAL) || defined(KERF_STANDARD_THREADS)
  Team team(threads);
  team.lead(work);
#else
  if (tbb::this_task_arena::max_concurrency() == threads) return isolated(work);
  tbb::task_arena arena(threads);
  arena.execute(work);
#endif
}

}  // namespace scheduler
}  // namespace kerf
