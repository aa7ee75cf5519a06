#include "workbench/open/load_scene.hpp"

#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/temporary_directory.hpp"

namespace workbench {
namespace {

using namespace kerf;

TEST(LoadScene, KeepsTheNameAsWritten) {
  EXPECT_EQ(load_scene("sticks:detail=0.01").name, "sticks:detail=0.01");
}

TEST(LoadScene, RotatesAboutZThenYThenXAndTheViewpointsWithIt) {
  const Scene still = load_scene("sticks:detail=0.01"), turned = load_scene("sticks:rotate=90,detail=0.01");
  // A right angle about z, y and x in turn takes (x, y, z) to (-y, x, z), to (z, x, y), to (z, -y, x).
  const auto turn = [](const Vec3f& p) { return Vec3f{p.z, -p.y, p.x}; };
  ASSERT_EQ(still.vertices.size(), turned.vertices.size());
  for (std::size_t i = 0; i < still.vertices.size(); ++i)
    ASSERT_EQ(turned.vertices[i], turn(still.vertices[i]));
  for (std::size_t i = 0; i < still.viewpoints.size(); ++i) {
    EXPECT_EQ(turned.viewpoints[i].position, turn(still.viewpoints[i].position));
    EXPECT_EQ(turned.viewpoints[i].target, turn(still.viewpoints[i].target));
    EXPECT_EQ(turned.viewpoints[i].up, turn(still.viewpoints[i].up));
  }
}

TEST(LoadScene, ReadsFilesWithColonsInTheirNames) {
  const TemporaryDirectory directory;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string_view name : {"a:b.obj", "a:rotate=1.obj"}) {
    const std::string file = directory.write(name, triangle);
    EXPECT_EQ(load_scene(file).triangles.size(), 1u);
    EXPECT_NE(load_scene(file + ":rotate=30").vertices, load_scene(file).vertices);
  }
}

TEST(LoadScene, NamesWhatIsWrongWithTheOptions) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const auto& [spec, cause] : {std::pair<std::string, std::string>{"sticks:turn=30", "turn"},
                                    {"sticks:rotate=far", "far"},
                                    {"sticks:rotate", "rotate"},
                                    {"sticks:rotate=nan", "nan"},
                                    {"sticks:detail=-1", "detail"},
                                    {"sticks:detail=0", "detail"},
                                    {"sticks:detail=1,,rotate=3", "unknown option ''"},
                                    {file + ":detail=2", "detail"},
                                    {file + ":shine=2", "shine"},
                                    {"no_such_scene", "no_such_scene"},
                                    {"no_such_scene:rotate=3", "no_such_scene"}}) {
    SCOPED_TRACE(spec);
    try {
      load_scene(spec);
      ADD_FAILURE() << "was loaded";
    } catch (const Error& error) {
      EXPECT_NE(std::string_view(error.what()).find(cause), std::string_view::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace workbench
