// A process that is killed while it saves leaves the old file or the new one.
#include <random>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"

TEST(SaveCrash, KillingTheProcessLeavesTheOldFileOrTheNewOne) {
  const TemporaryDirectory directory;
  const auto path = directory / "scene.kerf";
  const kerf::Bvh first = kerf::build(workbench::make_sphere(4).mesh());
  const kerf::Bvh second = kerf::build(workbench::make_torus(64, 32).mesh());
  second.save(path);
  const std::string second_bytes = read_bytes(path);
  first.save(path);
  const std::string first_bytes = read_bytes(path);

  std::mt19937 random(1);
  std::size_t killed = 0;
  for (int round = 0; round < 200; ++round) {
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {  // saves one and the other for ever
      if (::write(ready[1], "", 1) != 1) ::_exit(1);
      for (;;) {
        second.save(path);
        first.save(path);
      }
    }
    char byte;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    ::usleep(static_cast<useconds_t>(random() % 8000));
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    killed += WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    const std::string bytes = read_bytes(path);
    ASSERT_TRUE(bytes == first_bytes || bytes == second_bytes) << "round " << round;
    ASSERT_NO_THROW(kerf::Bvh::load(path));
  }
  EXPECT_EQ(killed, 200u);
}
