// A caller's own threads.
#include <algorithm>
#include <limits>

#include <kerf/threads.hpp>

#include "base/raise.hpp"
#include "base/team.hpp"

namespace kerf {

void run_on(const ThreadPool& pool, const std::function<void()>& work) {
  if (!pool.threads || !pool.start || !work)
    raise(Error::invalid_argument, "run_on needs work, and both functions of the pool");
  const unsigned most = std::numeric_limits<int>::max();
  Team team(static_cast<int>(std::clamp(pool.threads(), 1u, most)), &pool);
  team.lead(work);
}

}  // namespace kerf
