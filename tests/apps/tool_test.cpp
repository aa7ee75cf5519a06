// The command-line tool, run as a user runs it: exit statuses, JSON, tables, pictures.
#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "support/run_tool.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace {

using namespace kerf_tests;
namespace fs = std::filesystem;
using Json = nlohmann::json;

// Small enough for sanitizers; three rounds of timing are the fewest.
const std::string small = "sticks:detail=0.02";
const std::string quick = " --pixels 24x16 --rounds 3 ";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// One line that begins `kerf: ` and names `name`.
void expect_one_line_about(const std::string& errors, const std::string& name) {
  EXPECT_TRUE(errors.starts_with("kerf: ")) << errors;
  EXPECT_EQ(count(errors, "\n"), 1u) << errors;
  EXPECT_NE(errors.find(name), std::string::npos) << errors;
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

void expect_keys(const Json& object, const std::vector<std::string>& keys) {
  ASSERT_TRUE(object.is_object());
  for (const std::string& key : keys) EXPECT_TRUE(object.contains(key)) << key;
}

// Every field that `kerf compare --json` promises, with its type.
void expect_builder_fields(const Json& builder) {
  expect_keys(builder, {"name", "alpha", "build_ms", "sah", "epo", "references", "nodes", "bytes", "rays"});
  EXPECT_TRUE(builder["name"].is_string());
  for (const char* key : {"alpha", "build_ms", "sah", "epo"})
    EXPECT_TRUE(builder[key].is_number_float()) << key;
  for (const char* key : {"references", "nodes", "bytes"})
    EXPECT_TRUE(builder[key].is_number_unsigned()) << key;
  EXPECT_EQ(keys_of(builder["rays"]), (std::vector<std::string>{"ao", "diffuse", "primary"}));
  for (const auto& [type, rays] : builder["rays"].items()) {
    expect_keys(rays, {"count", "hits", "steps", "triangle_tests", "mrays_per_s"});
    EXPECT_TRUE(rays["count"].is_number_unsigned()) << type;
    EXPECT_TRUE(rays["hits"].is_number_unsigned()) << type;
    EXPECT_GT(rays["steps"], 0.0) << type;
    EXPECT_GT(rays["triangle_tests"], 0.0) << type;
    EXPECT_GT(rays["mrays_per_s"], 0.0) << type;
    EXPECT_LE(rays["hits"], rays["count"]) << type;
  }
}

TEST(Tool, PrintsItsVersion) {
  const Outcome outcome = run_tool("--version");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.output.starts_with("kerf ")) << outcome.output;
}

TEST(Tool, HelpNamesEverySubcommand) {
  const Outcome outcome = run_tool("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* command : {"scenes", "info", "compare", "sweep", "render"}) {
    EXPECT_NE(outcome.output.find(command), std::string::npos) << command;
    EXPECT_EQ(run_tool(std::string(command) + " --help").status, 0) << command;
  }
}

TEST(Tool, BadUsageIsStatusTwoAndOneLine) {
  for (const std::string arguments : {"",
                                      "nonsense",
                                      "compare",
                                      "render atrium",
                                      "compare --alpha 7 sticks",
                                      "compare --alpha x sticks",
                                      "compare --alpha nan sticks",
                                      "compare --builders foo sticks",
                                      "compare --builders bvh,bvh sticks",
                                      "compare --builders '' sticks",
                                      "compare --threads -1 sticks",
                                      "compare --threads 1.5 sticks",
                                      "compare --rounds 2 sticks",
                                      "compare --pixels 0x9 sticks",
                                      "compare --device gpu sticks",
                                      "compare --builders sbvh:good sticks",
                                      "compare --builders sbvh,sbvh:fast sticks",
                                      "build sticks -o x.kerf --quality good",
                                      "build sticks -o x.kerf --quality best --seconds -1",
                                      "bench sticks --quality good",
                                      "sweep sticks --budgets 0.5",
                                      "sweep sticks --budgets 2,2",
                                      "sweep sticks --budgets 2 --alphas 0",
                                      "sweep sticks --builders sbvh",
                                      "compare --no-such-option sticks",
                                      "bench sticks --rays ready",
                                      "bench sticks --motion 101",
                                      "bench sticks --motion ''",
                                      "bench sticks --peer-isa mmx",
                                      "compare sticks:nonsense=1",
                                      "compare sticks:detail=x",
                                      "sweep sticks --alphas 1,2",
                                      "sweep sticks --alphas ,",
                                      "info sticks --builder bvh,sbvh",
                                      "render sticks -o x.png --size 0x0",
                                      "render sticks -o x.png --size 12",
                                      "render sticks -o x.png --size 99999x1",
                                      "render sticks -o x.png --mode pretty",
                                      "render sticks:detail=0.01 -o x.png --view 99",
                                      "render sticks -o x.png --view -1"}) {
    const Outcome outcome = run_tool(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.output, "") << arguments;
    expect_one_line_about(outcome.errors, "");
  }
  EXPECT_FALSE(std::filesystem::exists("x.png"));
}

TEST(Tool, BadInputIsStatusOneAndOneLineThatNamesTheFile) {
  const TemporaryDirectory directory;
  write_bytes(directory.file("empty.obj"), "");
  write_bytes(directory.file("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  write_bytes(directory.file("scene.xyz"), "0 0 0\n");
  for (const char* name : {"missing.obj", "empty.obj", "points.obj", "scene.xyz"}) {
    for (const char* command : {"info", "compare", "sweep"}) {
      const Outcome outcome = run_tool(std::string(command) + " " + directory.file(name));
      EXPECT_EQ(outcome.status, 1) << command << " " << name;
      EXPECT_EQ(outcome.output, "");
      expect_one_line_about(outcome.errors, directory.file(name));
    }
  }
}

TEST(Tool, MakesATreeForRaysOfAFileOrOfTheViewpoints) {
  const TemporaryDirectory directory;
  write_bytes(directory.file("down.txt"), "0 0 9 0 0 -1\n1,1,9, 0,0,-1, 20\n");
  for (const std::string& rays : {std::string("auto"), directory.file("down.txt")}) {
    const Outcome outcome =
        run_tool("build " + small + " -o " + directory.file("a.kerf") + " --rays " + rays);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_EQ(run_tool("info " + directory.file("a.kerf")).status, 0);
  }
  write_bytes(directory.file("short.txt"), "0 0 9\n");
  const Outcome outcome = run_tool("build " + small + " -o " + directory.file("b.kerf") + " --rays " +
                                   directory.file("short.txt"));
  EXPECT_EQ(outcome.status, 1);
  expect_one_line_about(outcome.errors, "short.txt: line 1");
  EXPECT_FALSE(std::filesystem::exists(directory / "b.kerf"));
}

TEST(Tool, SaysBeforeLongWorkThatOutputCannotBeWritten) {
  // The scenes do not exist: had they been looked at first, the line would name them.
  for (const std::string arguments :
       {"compare nothing.obj --json /nowhere/x.json", "compare nothing.obj --report /dev/null/report",
        "sweep nothing.obj --json /nowhere/x.json", "render nothing.obj -o /nowhere/x.png"}) {
    const Outcome outcome = run_tool(arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    expect_one_line_about(outcome.errors, arguments.substr(arguments.find_last_of(' ') + 1));
  }
}

TEST(Tool, AFullDiskIsAnError) {
  const Outcome outcome = run_tool("render " + small + " --size 8x8 -o /dev/full");
  EXPECT_EQ(outcome.status, 1);
  expect_one_line_about(outcome.errors, "/dev/full");
}

TEST(Tool, CompareJsonHasItsFieldsAndStandsAlone) {
  const Outcome outcome = run_tool("compare terrain:detail=0.01 " + small + quick + " --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "") << "a pipe shows no progress";
  const Json json = Json::parse(outcome.output);
  EXPECT_TRUE(json["kerf"].is_string());
  ASSERT_EQ(json["scenes"].size(), 2u);
  EXPECT_EQ(json["scenes"][0]["name"], "terrain:detail=0.01");
  EXPECT_EQ(json["scenes"][1]["name"], small);
  for (const Json& scene : json["scenes"]) {
    ASSERT_TRUE(scene["triangles"].is_number_unsigned());
    ASSERT_EQ(scene["builders"].size(), 4u);
    const char* const names[] = {"bvh", "sbvh", "esc", "evh"};
    for (std::size_t i = 0; i < 4; ++i) {
      const Json& builder = scene["builders"][i];
      EXPECT_EQ(builder["name"], names[i]);
      EXPECT_EQ(builder["alpha"], 1e-5);
      expect_builder_fields(builder);
      EXPECT_EQ(builder["disagreements"], 0u);
      for (const char* type : {"primary", "ao", "diffuse"}) {  // the same rays hit the same in every tree
        EXPECT_EQ(builder["rays"][type]["count"], scene["builders"][0]["rays"][type]["count"]);
        EXPECT_EQ(builder["rays"][type]["hits"], scene["builders"][0]["rays"][type]["hits"]);
      }
    }
    EXPECT_EQ(scene["builders"][0]["references"], scene["triangles"]) << "object splits duplicate nothing";
  }
}

TEST(Tool, EscAndEvhGetAtMostTheReferencesOfTheSbvhThatIsNotAsked) {
  const Json with =
      Json::parse(run_tool("compare " + small + quick + " --json -").output)["scenes"][0]["builders"];
  const Json without = Json::parse(
      run_tool("compare " + small + quick + " --builders esc,evh --json -").output)["scenes"][0]["builders"];
  ASSERT_EQ(without.size(), 2u);
  EXPECT_EQ(without[0]["references"], with[2]["references"]);
  EXPECT_EQ(without[1]["references"], with[3]["references"]);
}

TEST(Tool, QualitiesAreContendersWhoseTreesCostLess) {
  const Json builders =
      Json::parse(run_tool("compare " + small + quick + " --builders sbvh,sbvh:high,sbvh:best --json -")
                      .output)["scenes"][0]["builders"];
  ASSERT_EQ(builders.size(), 3u);
  EXPECT_EQ(builders[0]["name"], "sbvh");
  EXPECT_EQ(builders[1]["name"], "sbvh:high");
  EXPECT_EQ(builders[2]["name"], "sbvh:best");
  EXPECT_LT(builders[1]["sah"], builders[0]["sah"]);
  EXPECT_LT(builders[2]["sah"], builders[1]["sah"]);
}

// The setting of the paper's figures beside kerf's own.
TEST(Tool, BinaryTreesTakeMoreStepsThanWideOnesAndFindTheSame) {
  const Outcome outcome =
      run_tool("compare " + small + quick + " --builders bvh,sbvh --device binary --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;  // which it is not where hits differ
  const Json builders = Json::parse(outcome.output)["scenes"][0]["builders"];
  ASSERT_EQ(builders.size(), 4u);
  for (std::size_t i = 0; i < 4; i += 2) {
    EXPECT_EQ(builders[i]["structure"], "binary");
    EXPECT_EQ(builders[i + 1]["structure"], "wide");
    for (const char* type : {"primary", "ao", "diffuse"})
      EXPECT_GT(builders[i]["rays"][type]["steps"],
                1.5 * builders[i + 1]["rays"][type]["steps"].get<double>());
  }
}

TEST(Tool, SweepOverBudgetsGivesEachBuilderAsManyReferencesAsTheSbvhHas) {
  const Json builders = Json::parse(run_tool("sweep conference:detail=0.05,rotate=20" + quick +
                                             " --budgets 1,1.1,2 --builders sbvh,esc --json -")
                                        .output)["scenes"][0]["builders"];
  ASSERT_EQ(builders.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json &sbvh = builders[i], &esc = builders[i + 3];
    EXPECT_EQ(sbvh["name"], "sbvh");
    EXPECT_EQ(esc["name"], "esc");
    EXPECT_EQ(sbvh["max_reference_ratio"], (std::array{1.0, 1.1, 2.0})[i]);
    // Within a thousandth: decision 0017.
    EXPECT_NEAR(esc["references"].get<double>(), sbvh["references"].get<double>(),
                1e-3 * sbvh["references"].get<double>());
    if (i > 0) {
      EXPECT_GT(sbvh["references"], builders[i - 1]["references"]);
    }
  }
}

TEST(Tool, TheTableInAPipeMarksTheBestAndHasNoEscapes) {
  const Outcome outcome = run_tool("compare " + small + quick + " --builders bvh,sbvh");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.errors, "");
  EXPECT_EQ(outcome.output.find('\033'), std::string::npos);
  EXPECT_NE(outcome.output.find('*'), std::string::npos);
  EXPECT_NE(outcome.output.find("×"), std::string::npos);
  EXPECT_NE(outcome.output.find("hits of all agree"), std::string::npos);
}

TEST(Tool, JsonInAFileLeavesTheTableOnStandardOutput) {
  const TemporaryDirectory directory;
  const Outcome outcome =
      run_tool("compare " + small + quick + " --builders bvh --json " + directory.file("figures.json"));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.output.find("SAH"), std::string::npos);
  EXPECT_EQ(Json::parse(read_bytes(directory.file("figures.json")))["scenes"][0]["builders"].size(), 1u);
}

TEST(Tool, SweepHasAnEntryForEachAlphaWhoseCostFalls) {
  const Outcome outcome = run_tool("sweep " + small + quick + " --alphas 1,1e-2,1e-5,0 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json builders = Json::parse(outcome.output)["scenes"][0]["builders"];
  const double alphas[] = {1.0, 1e-2, 1e-5, 0.0};
  ASSERT_EQ(builders.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_builder_fields(builders[i]);
    EXPECT_EQ(builders[i]["name"], "sbvh");
    EXPECT_EQ(builders[i]["alpha"], alphas[i]);
    EXPECT_LE(builders[i]["sah"], builders[0]["sah"]);
    EXPECT_GE(builders[i]["references"], builders[0]["references"]);
  }
  EXPECT_LT(builders[3]["sah"], builders[0]["sah"]) << "sticks are what spatial splits are for";
}

TEST(Tool, RendersTheSamePictureWithEveryBuilder) {
  const TemporaryDirectory directory;
  std::string first;
  for (const char* builder : {"bvh", "sbvh", "esc", "evh"}) {
    const std::string file = directory.file(std::string(builder) + ".png");
    const Outcome outcome =
        run_tool("render " + small + " --size 33x21 --view 1 --builder " + builder + " -o " + file);
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    const std::string png = read_bytes(file);
    // Width and height stand big-endian in the header chunk (PNG specification, section 11.2.1).
    ASSERT_GT(png.size(), 24u);
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x21\0\0\0\x15", 8));
    if (first.empty()) first = png;
    EXPECT_EQ(png, first) << builder;
  }
}

TEST(Tool, RendersThreeModesThatDiffer) {
  std::vector<std::string> pictures;
  for (const char* mode : {"shaded", "ao", "steps"}) {
    const Outcome outcome = run_tool("render " + small + " --size 16x16 -o - --mode " + mode);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_TRUE(outcome.output.starts_with("\x89PNG"));
    EXPECT_EQ(std::count(pictures.begin(), pictures.end(), outcome.output), 0) << mode;
    pictures.push_back(outcome.output);
  }
}

// Three octahedra by three nodes that show one mesh, and one by a node of its own.
std::string file_of_instances(const TemporaryDirectory& directory) {
  const std::string points =
      "AACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAvwAAAAAAAAAAAAAAAAAAgL8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIC/";
  const std::string corners = "AAABAAQAAQACAAQAAgADAAQAAwAAAAQAAQAAAAUAAgABAAUAAwACAAUAAAADAAUA";
  const Json primitives = {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}};
  const Json gltf = {
      {"asset", {{"version", "2.0"}}},
      {"scenes", {{{"nodes", {0, 1, 2, 3}}}}},
      {"nodes",
       {{{"mesh", 0}},
        {{"mesh", 0}, {"translation", {2, 0, 0}}},
        {{"mesh", 0}, {"translation", {0, 2, 0}}, {"scale", {2, 1, 0.5}}},
        {{"mesh", 1}, {"translation", {2, 2, 0}}}}},
      {"meshes", {{{"primitives", primitives}}, {{"primitives", primitives}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5123}, {"count", 24}, {"type", "SCALAR"}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", 72}}, {{"buffer", 1}, {"byteLength", 48}}}},
      {"buffers",
       {{{"byteLength", 72}, {"uri", "data:application/octet-stream;base64," + points}},
        {{"byteLength", 48}, {"uri", "data:application/octet-stream;base64," + corners}}}}};
  write_bytes(directory / "instances.gltf", gltf.dump());
  return directory.file("instances.gltf");
}

TEST(Tool, InstancesAreKeptShownAndTraced) {
  const TemporaryDirectory directory;
  const std::string file = file_of_instances(directory), saved = directory.file("instances.kerf");
  ASSERT_EQ(run_tool("build " + file + " -o " + saved).status, 0);
  for (const std::string& name : {file, saved}) {
    SCOPED_TRACE(name);
    const Outcome outcome = run_tool("info " + name);
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_NE(outcome.output.find("instances             4 of 2 meshes"), std::string::npos)
        << outcome.output;
    EXPECT_NE(outcome.output.find("triangles             32, of 16 in meshes"), std::string::npos);
    const Json info = Json::parse(run_tool("info " + name + " --json -").output);
    EXPECT_EQ(info["triangles"], 32);
    EXPECT_EQ(info["shared"]["instances"], 4);
    EXPECT_EQ(info["shared"]["triangles"], 16);
    EXPECT_EQ(info["closed"], true);
    const Json bench =
        Json::parse(run_tool("bench " + name + " --threads 1 --peers none --json -").output)["scenes"][0];
    EXPECT_EQ(bench["instances"], 4);
    EXPECT_EQ(bench["meshes"], 2);
    EXPECT_GT(bench["results"][0]["rays"]["primary"]["hits"], 0);
    // One picture, whether the file is traced as it is, or copied for a builder.
    const std::string view = " --size 40x30 --eye 1,3,9 --at 1.5,1.5,0.3 -o -";
    const std::string picture = run_tool("render " + name + view).output;
    EXPECT_GT(picture.size(), 100u);
    if (name == file) {
      EXPECT_EQ(run_tool("render " + saved + view).output, picture);
    }
  }
  const Json copied = Json::parse(run_tool("info " + file + " --builder sbvh --json -").output);
  EXPECT_EQ(copied["triangles"], 32);
  EXPECT_TRUE(copied["shared"].is_null());
  EXPECT_EQ(run_tool("compare " + file + quick + " --json -").status, 0);
}

TEST(Tool, InfoCountsWhatTheFileHolds) {
  const TemporaryDirectory directory;
  write_bytes(directory.file("two.obj"),
              "v 0 0 0\nv 4 0 0\nv 0 5 0\nv 0 0 6\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");  // the third has no area
  const Outcome outcome = run_tool("info " + directory.file("two.obj"));
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  for (const char* part :
       {"(0, 0, 0) to (4, 5, 6)", "nodes", "depth", "leaf sizes", "references", "SAH", "EPO", "bytes"}) {
    EXPECT_NE(outcome.output.find(part), std::string::npos) << part << "\n" << outcome.output;
  }
}

TEST(Tool, InfoSaysWhatWasLeftOut) {
  const TemporaryDirectory directory;
  const std::string file =
      directory.write("all.obj", "v 0 0 0\nv 4 0 0\nv 0 5 0\nf 1 2 3\nf 1 2\nl 1 2\nl 2 3\np 1\n");
  const Outcome outcome = run_tool("info " + file);
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  for (const char* part :
       {"faces left out        1, of fewer than three corners", "lines and points      3 statements"})
    EXPECT_NE(outcome.output.find(part), std::string::npos) << part << "\n" << outcome.output;
}

TEST(Tool, NamesTheRemedyWhereRoundingDestroysTriangles) {
  const TemporaryDirectory directory;
  // Floats near 6,000,000 are half a metre apart. The second triangle has no area in the file either.
  const std::string file = directory.write(
      "far.obj",
      "v 6000000.1 0 0\nv 6000000.2 0 0\nv 6000000.2 1 0\nv 6000000 0 0\nv 6000002 0 0\nv 6000004 0 0\n"
      "v 6000000 3 0\nf 1 2 3\nf 4 5 6\nf 4 5 7\n");
  for (const std::string& command : {"info " + file, "build " + file + " -o " + directory.file("far.kerf")}) {
    const Outcome outcome = run_tool(command);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    expect_one_line_about(outcome.errors, file);
    EXPECT_NE(outcome.errors.find("the area of 1 of 3 triangles"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.errors.find("local frame"), std::string::npos) << outcome.errors;
  }
  EXPECT_NE(run_tool("info " + file).output.find("flattened             1 triangle, by rounding"),
            std::string::npos);
}

TEST(Tool, ListsEveryGeneratedScene) {
  const Outcome outcome = run_tool("scenes");
  EXPECT_EQ(outcome.status, 0);
  for (const auto& scene : workbench::generated_scenes()) {
    EXPECT_NE(outcome.output.find(fmt::format("\n{} ", scene.name)), std::string::npos) << scene.name;
  }
}

TEST(Tool, ATriangleWithoutAreaAloneIsTracedAndMissed) {
  const TemporaryDirectory directory;
  write_bytes(directory.file("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const Outcome outcome = run_tool("compare " + directory.file("line.obj") + quick + "--json -");
  if (outcome.status == 1) return expect_one_line_about(outcome.errors, directory.file("line.obj"));
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const Json comparison = Json::parse(outcome.output);
  for (const Json& builder : comparison["scenes"][0]["builders"]) {
    EXPECT_EQ(builder["references"], 0u);
    EXPECT_EQ(builder["rays"]["primary"]["hits"], 0u);
  }
}

// A triangle of each side of a cube, turned outwards, as text for .obj files.
const std::string cube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(Tool, NamesUnknownCommandsAndScenesAndTheNearest) {
  for (const auto& [arguments, part] :
       {std::pair("rendr atrium -o x.png", "there is no command 'rendr'; did you mean render?"),
        std::pair("frobnicate", "there is no command 'frobnicate'; the commands are scenes, info"),
        std::pair("info atruim",
                  "atruim: no such file, and no generated scene of that name; did you mean atrium?"),
        std::pair("info atrium --buidler bvh", "; did you mean --builder?"),
        std::pair("info atrium --frobnicate", "--frobnicate; kerf --help says more"),
        std::pair("build atrium -o x.kerf one --two three", "not expected: one --two three; kerf --help"),
        std::pair("", "a command is required: scenes, info"),
        std::pair("info nowhere/at/all.obj", "nowhere/at/all.obj: no such file\n")}) {
    const Outcome outcome = run_tool(arguments);
    EXPECT_NE(outcome.status, 0);
    expect_one_line_about(outcome.errors, part);
  }
}

TEST(Tool, AnUnknownInstructionSetIsOneLine) {
  const Outcome outcome = run_command("KERF_TARGET=AVX9 " + tool() + " info " + small);
  EXPECT_EQ(outcome.status, 1);
  expect_one_line_about(outcome.errors, "KERF_TARGET is \"AVX9\"");
}

TEST(Tool, FilesAreWholeOrAsBefore) {
  const TemporaryDirectory directory;
  const std::string old = "what was there";
  const auto limited = [&](const std::string& arguments) {  // files of at most 512 bytes, as on a full disk
    return run_command("trap '' XFSZ; ulimit -f 1; (" + tool() + " " + arguments + " >/dev/null)");
  };
  for (const std::string& command :
       {"render " + small + " --size 64x48 -o " + directory.write("a.png", old),
        "info " + small + " --json " + directory.write("a.json", old),
        "compare " + small + quick + " --builders bvh --json " + directory.write("b.json", old)}) {
    const Outcome outcome = limited(command);
    EXPECT_EQ(outcome.status, 1) << command;
    EXPECT_EQ(read_bytes(command.substr(command.find_last_of(' ') + 1)), old) << command;
  }
  EXPECT_EQ(
      limited("compare " + small + quick + " --builders bvh --pictures 8x8 --report " + directory.file("r/s"))
          .status,
      1);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
    left.push_back(entry.path().filename());
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"a.json", "a.png", "b.json"})) << "no part, and no empty folder";
}

// Runs the tool, sends it SIGINT as soon as there is a file in `directory` that was not there before, and
// says how it ended, as `waitpid` does.
int interrupt_while_it_writes(const TemporaryDirectory& directory, std::vector<std::string> arguments) {
  const auto holds_a_new_file = [&] {
    std::error_code gone;
    for (fs::recursive_directory_iterator i(directory.path(), gone), end; i != end; i.increment(gone)) {
      if (i->path().extension() == ".tmp" && i->file_size(gone) > 0) return true;
      if (gone) return false;
    }
    return false;
  };
  std::vector<char*> words;
  std::string program = tool();
  program.erase(std::remove(program.begin(), program.end(), '\''), program.end());
  words.push_back(program.data());
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGINT, SIG_DFL);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3; ++stream) ::dup2(nowhere, stream);
    ::execv(words[0], words.data());
    ::_exit(127);
  }
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!holds_a_new_file()) continue;
    ::kill(child, SIGINT);
    ::waitpid(child, &status, 0);
    break;
  }
  return status;
}

TEST(Tool, InterruptedWhileItWritesItLeavesNothing) {
  const std::string quickly = "16x16";
  int interrupted = 0;
  for (int round = 0; round < 3; ++round) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"render", small, "--size", "500x400", "-o", "a.png"},
                                               {"compare", small, "--builders", "bvh", "--pixels", quickly,
                                                "--pictures", "100x80", "--report", "new/report"},
                                               {"build", "terrain:detail=0.2", "-o", "a.kerf"}}) {
      const TemporaryDirectory directory;
      std::vector<std::string> arguments = command;
      const std::string old = command[0] == "compare" ? "" : directory.write(command.back(), "old");
      arguments.back() = directory.file(command.back());
      const int status = interrupt_while_it_writes(directory, arguments);
      if (WIFSIGNALED(status)) {
        EXPECT_EQ(WTERMSIG(status), SIGINT) << command[0];
        ++interrupted;
      } else {
        EXPECT_EQ(WEXITSTATUS(status), 0) << command[0];
      }
      // Interrupted before the new file had its name, or after.
      for (const auto& entry : fs::recursive_directory_iterator(directory.path())) {
        const std::string name = entry.path().filename();
        EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
        if (entry.is_directory()) {
          EXPECT_TRUE(fs::exists(directory.path() / "new/report/index.html")) << entry.path();
        }
      }
      if (!old.empty()) {
        EXPECT_TRUE(fs::exists(old)) << command[0];
      }
    }
  }
  EXPECT_GT(interrupted, 0) << "none was met while it wrote";
}

TEST(Tool, PicturesOfHeapsOfEqualTrianglesEndSoon) {
  const TemporaryDirectory directory;
  std::string heap = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 50'000; ++i) heap += "f 1 2 3\n";
  const std::string file = directory.write("heap.obj", heap), picture = directory.file("a.png");
  for (const char* mode : {"shaded", "ao", "steps"}) {
    const Outcome outcome = run_command("timeout 100 " + tool() + " render " + file +
                                        " --size 160x120 --mode " + mode + " -o " + picture);
    EXPECT_EQ(outcome.status, 0) << mode;
    expect_one_line_about(outcome.errors, "blocks of");
  }
}

TEST(Tool, LegendsHaveNumbersOfAnySize) {
  const TemporaryDirectory directory;
  std::string last;
  for (const char* scale : {"0.00001", "40", "12000", "100000", "9e8"}) {
    const std::string picture = directory.file("a.png");
    EXPECT_EQ(run_tool("render " + small + " --mode steps --size 400x300 --scale " + scale + " -o " + picture)
                  .status,
              0)
        << scale;
    EXPECT_NE(read_bytes(picture), last) << scale;
    last = read_bytes(picture);
  }
}

TEST(Tool, LinksStayAndPermissionsToo) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.json", "old");
  std::filesystem::permissions(file,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("a.json", directory.path() / "link.json");
  ASSERT_EQ(run_tool("info " + small + " --json " + directory.file("link.json")).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(directory.path() / "link.json"));
  EXPECT_EQ(Json::parse(read_bytes(file))["name"], small);
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST(Tool, OutputsThatNobodyCouldReadAreRefused) {
  const TemporaryDirectory directory;
  for (const std::string& arguments :
       {"info " + small + " --json ''", "compare " + small + " --json ''",
        "compare " + small + " --report ''", "bench " + small + " --json ''", "build " + small + " -o ''",
        "build " + small + " -o " + directory.file("noending"),
        "render " + small + " -o " + directory.file("a.jpg")}) {
    const Outcome outcome = run_tool(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    expect_one_line_about(outcome.errors, "");
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Tool, ADashIsStandardOutputAndStandardInput) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("cube.obj", cube), saved = directory.file("cube.kerf");
  ASSERT_EQ(run_tool("build " + file + " -o " + saved).status, 0);
  EXPECT_EQ(run_tool("build " + file + " -o -").output, read_bytes(saved));
  const Outcome outcome = run_command("(cat " + file + " | " + tool() + " info - --format obj)");
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("triangles             12"), std::string::npos) << outcome.output;
}

TEST(Tool, FormatSaysWhatAFileWithoutAnEndingIs) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("cube", cube);
  expect_one_line_about(run_tool("info " + file).errors, "--format");
  EXPECT_EQ(run_tool("info --format obj " + file).status, 0);
  EXPECT_EQ(run_tool("info --format xyz " + file).status, 2);
}

TEST(Tool, InfoOfAHierarchyDescribesTheTreeInTheFile) {
  const TemporaryDirectory directory;
  const std::string plain = directory.file("plain.kerf");
  ASSERT_EQ(run_tool("build " + small + " --builder bvh -o " + plain).status, 0);
  const Json saved = Json::parse(run_tool("info " + plain + " --json -").output);
  EXPECT_EQ(saved["tree"]["references"], saved["triangles"]) << "a plain BVH duplicates nothing";
  EXPECT_TRUE(std::string(saved["tree"]["title"]).starts_with("saved tree")) << saved["tree"]["title"];
  const Json anew = Json::parse(run_tool("info " + plain + " --builder sbvh --json -").output);
  EXPECT_GT(anew["tree"]["references"], anew["triangles"]);
  EXPECT_EQ(anew["tree"]["title"], "sbvh tree");
}

TEST(Tool, InfoSaysWhetherASurfaceIsClosedAndWhatIsDoubled) {
  const TemporaryDirectory directory;
  const Json closed = Json::parse(run_tool("info --json - " + directory.write("a.obj", cube)).output);
  EXPECT_EQ(closed["closed"], true);
  EXPECT_EQ(closed["doubled_triangles"], 0);
  EXPECT_EQ(closed["bounds"]["upper"], (std::vector<double>{1, 1, 1}));
  const Json open =
      Json::parse(run_tool("info --json - " + directory.write("b.obj", cube + "f 1 2 5\n")).output);
  EXPECT_EQ(open["closed"], false);
  EXPECT_EQ(open["open_edges"], 3);
  EXPECT_EQ(open["doubled_triangles"], 1);
}

TEST(Tool, NamesThatAreNotUtf8LoseNothing) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("caf\xe9.obj", cube);
  const Outcome outcome =
      run_tool("compare " + file + quick + " --builders bvh --pictures 8x8 --json - --report " +
               directory.file("report"));
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(Json::parse(outcome.output)["scenes"][0]["triangles"], 12u);
  EXPECT_TRUE(std::filesystem::exists(directory.file("report/index.html")));
}

TEST(Tool, JsonSaysWhichRunItCameFrom) {
  const Json compared =
      Json::parse(run_tool("compare " + small + quick + " --builders bvh --threads 1 --json -").output);
  const Json benched =
      Json::parse(run_tool("bench sticks:detail=0.001 --peers none --threads 1 --json -").output);
  for (const Json& json : {compared, benched}) {
    expect_keys(json, {"kerf", "date", "threads", "target", "machine", "scenes"});
    EXPECT_EQ(json["threads"], 1u);
    expect_keys(json["machine"], {"processor", "threads", "system", "compiler"});
  }
}

TEST(Tool, BenchEndsWhereNoRayHits) {
  const TemporaryDirectory directory;
  const std::string line = directory.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const Outcome outcome = run_tool("bench " + line + " --threads 1");
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(outcome.output.find("nan"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("inf"), std::string::npos) << outcome.output;
}

TEST(Tool, RendersWhatTheCameraIsToldTo) {
  const TemporaryDirectory directory;
  // As the cube, 3 wide, 1 high and 2 deep.
  const std::string slab = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 0 1 0\nv 0 0 2\nv 3 0 2\nv 3 1 2\nv 0 1 2\n" +
                           cube.substr(cube.find("f 4"));
  const std::string file = directory.write("slab.obj", slab), picture = directory.file("a.png");
  const std::string begin = "render " + file + " --size 24x24 -o - ";
  const std::string front = run_tool(begin + "--view front").output;
  EXPECT_NE(run_tool(begin + "--view top").output, front);
  EXPECT_NE(run_tool(begin + "--view front --up z").output, front) << "from another side";
  EXPECT_EQ(run_tool(begin + "--eye 1.5,0.5,6 --at 1.5,0.5,1 --fov 45").output,
            run_tool(begin + "--eye 1.5,0.5,6 --fov 45").output)
      << "the middle is what a camera looks at";
  EXPECT_NE(run_tool(begin + "--mode steps --scale 10").output,
            run_tool(begin + "--mode steps --scale 20").output);
  for (const std::string arguments :
       {"--view fornt", "--at 0,0,0", "--eye 1,2", "--eye 1,2,3 --view top", "--up 0,0,0", "--fov 180",
        "--eye 1,2,3 --at 1,2,3", "--scale 5", "--mode steps --scale 0"}) {
    const Outcome outcome = run_tool("render " + file + " -o " + picture + " " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    expect_one_line_about(outcome.errors, "");
  }
  EXPECT_FALSE(std::filesystem::exists(picture));
}

// The longest line, in characters of UTF-8, without the escapes that change letters.
std::size_t widest_line(const std::string& output) {
  const std::string text = std::regex_replace(output, std::regex("\\x1b\\[[0-9;]*[mK]"), "");
  std::size_t widest = 0, columns = 0;
  for (const char byte : text) {
    if (byte == '\n' || byte == '\r')
      columns = 0;
    else if ((static_cast<unsigned char>(byte) & 0xc0) != 0x80)
      widest = std::max(widest, ++columns);
  }
  return widest;
}

// What people read: all commands, and the help of each.
std::vector<std::string> readable() {
  std::vector<std::string> list = {"scenes",
                                   "compare " + small + quick,
                                   "compare terrain:detail=0.01,rotate=30" + quick,
                                   "info " + small,
                                   "info terrain:detail=0.05",
                                   "sweep " + small + quick + "--alphas 1,0",
                                   "sweep " + small + quick + "--budgets 1,2",
                                   "bench sticks:detail=0.001 --peers none --threads 1 --limits",
                                   "--help"};
  for (const char* command :
       {"scenes", "info", "compare", "sweep", "render", "bench", "build", "manual", "completion"})
    list.push_back(std::string(command) + " --help");
  return list;
}

TEST(Tool, WhatPeopleReadFitsEightyColumns) {
  for (const std::string& arguments : readable())
    EXPECT_LE(widest_line(run_command("COLUMNS= " + tool() + " " + arguments).output), 80u) << arguments;
}

TEST(Tool, WhatPeopleReadFitsTheColumnsThatThereAre) {
  const std::string compare = "compare " + small + quick;
  const auto widest = [&](const std::string& columns, const std::string& arguments) {
    return widest_line(run_command("COLUMNS=" + columns + " " + tool() + " " + arguments).output);
  };
  for (const std::string& arguments : readable()) {
    if (arguments.ends_with("--help")) continue;  // some options are wider alone
    EXPECT_LE(widest("60", arguments), 60u) << arguments;
  }
  EXPECT_GT(widest("200", compare), 80u) << "a wide terminal folds nothing";
  EXPECT_GT(widest("200", "--help"), 80u);
}

// `script` gives the tool a terminal, 80 columns wide.
class ToolOnATerminal : public testing::Test {
 protected:
  void SetUp() override {
    if (run_command("command -v script").status != 0) GTEST_SKIP() << "there is no script of util-linux";
  }
  static std::string shown(const std::string& term, const std::string& arguments) {
    const TemporaryDirectory directory;
    const std::string commands = directory.write(
        "commands", "stty cols 80 rows 24\nCOLUMNS= TERM=" + term + " " + tool() + " " + arguments);
    return run_command("script -qec 'sh " + commands + "' /dev/null").output;
  }
};

TEST_F(ToolOnATerminal, NothingIsWiderThanIt) {
  for (const std::string& arguments : readable())
    EXPECT_LE(widest_line(shown("xterm", arguments)), 80u) << arguments;
}

TEST_F(ToolOnATerminal, InfoShowsWhatItIsAtAndRemovesIt) {
  const std::string text = shown("xterm", "info " + small);
  const std::size_t measures = text.find("measures of the tree"), removed = text.rfind("\r\033[K");
  ASSERT_NE(measures, std::string::npos);
  ASSERT_NE(removed, std::string::npos);
  EXPECT_LT(measures, removed);
  EXPECT_LT(removed, text.find("triangles"));
}

TEST_F(ToolOnATerminal, OneThatIsDumbGetsNoEscapes) {
  for (const std::string& arguments : readable())
    EXPECT_EQ(shown("dumb", arguments).find('\033'), std::string::npos) << arguments;
  EXPECT_NE(shown("xterm", "compare " + small + quick).find("\033[1m"), std::string::npos);
}

}  // namespace
