// Threads of the standard library that work on one call together.
#include "base/team.hpp"

#include <atomic>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace kerf {
namespace {

// Halves of halves, as builds divide their work.
std::size_t sum_below(Team& team, const std::vector<int>& values, std::size_t begin, std::size_t end) {
  if (end - begin <= 3)
    return std::accumulate(values.begin() + static_cast<long>(begin), values.begin() + static_cast<long>(end),
                           std::size_t{0},
                           [](std::size_t sum, int value) { return sum + static_cast<std::size_t>(value); });
  const std::size_t middle = begin + (end - begin) / 2;
  std::size_t left = 0, right = 0;
  team.invoke([&] { left = sum_below(team, values, begin, middle); },
              [&] { right = sum_below(team, values, middle, end); });
  return left + right;
}

TEST(Team, WorkWithinWorkIsAllDone) {
  const std::vector<int> ones(5000, 1);
  for (const int threads : {1, 2, 4}) {
    Team team(threads);
    EXPECT_EQ(team.lead([&] { return sum_below(team, ones, 0, ones.size()); }), ones.size());
  }
}

TEST(Team, ALoopVisitsEveryIndexOnce) {
  for (const int threads : {1, 3, 8}) {
    for (const std::size_t count : {0u, 1u, 7u, 1000u}) {
      Team team(threads);
      std::vector<std::atomic<int>> visits(count);
      team.loop(count, 10, [&](std::size_t begin, std::size_t end) {
        EXPECT_LE(end - begin, 10u);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& each : visits) EXPECT_EQ(each, 1);
    }
  }
}

TEST(Team, HasNoMoreThreadsThanItIsGiven) {
  Team team(3);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  team.loop(300, 1, [&](std::size_t, std::size_t) {
    const std::lock_guard lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_LE(seen.size(), 3u);
}

TEST(Team, IsTheCurrentOneForItsMembersOnly) {
  EXPECT_EQ(Team::current(), nullptr);
  {
    Team team(2);
    team.lead([&] {
      team.loop(100, 1, [&](std::size_t, std::size_t) { EXPECT_EQ(Team::current(), &team); });
      return 0;
    });
  }
  EXPECT_EQ(Team::current(), nullptr);
}

TEST(Team, WhatWorkThrowsComesOutWhenAllIsDone) {
  for (int round = 0; round < 20; ++round) {
    Team team(2);
    std::atomic<int> done = 0;
    const auto count = [&] { ++done; };
    const auto fail = [] { throw std::runtime_error("failed"); };
    EXPECT_THROW(team.invoke(fail, count), std::runtime_error);
    EXPECT_EQ(done, 1);
    EXPECT_THROW(team.invoke(count, fail), std::runtime_error);
    EXPECT_EQ(done, 2);
    EXPECT_THROW(team.loop(1000, 1,
                           [&](std::size_t begin, std::size_t) {
                             if (begin == 10) fail();
                           }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace kerf
