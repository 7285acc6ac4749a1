#include "cli.h"

namespace raymap {
namespace {

class CliDevices : public Cli {};

TEST_F(CliDevices, ListsDevices) {
  const Json json = Json::parse(succeed("devices --json").out);
  const Json& devices = json["devices"];
  ASSERT_GE(devices.size(), 1u);
  EXPECT_GE(devices[0]["threads"], 1);
  EXPECT_EQ(devices[0]["problem"], "");
  EXPECT_EQ(json["note"] != "", devices.size() == 1);
  size_t automatic = 0;
  for (size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i]["id"], i == 0 ? "cpu" : "vulkan:" + std::to_string(i - 1));
    if (devices[i]["chosen_by_auto"]) {
      ++automatic;
      EXPECT_EQ(devices[i]["problem"], "");
      EXPECT_NE(devices[i]["type"], "software");
    }
  }
  EXPECT_EQ(automatic, 1u);
  const std::string text = succeed("devices").out;
  EXPECT_NE(text.find("auto"), std::string::npos) << text;
  for (const Json& device : devices)
    EXPECT_NE(text.find(device["name"].get<std::string>()), std::string::npos) << text;
}

TEST_F(CliDevices, TestsDevices) {
  std::string gpu;
  const Json all = Json::parse(succeed("devices --json").out);
  for (const Json& device : all["devices"])
    if (device["id"] != "cpu" && device["problem"] == "") gpu = device["id"];
  if (gpu.empty()) GTEST_SKIP() << "no GPU";
  const std::string cache = "RAYMAP_CACHE='" + path("cache").string() + "'";
  const Result tested = run("devices --json --test " + gpu, cache);
  EXPECT_EQ(tested.code, 0) << tested.out;
  EXPECT_EQ(Json::parse(tested.out)["raymap"], version().text);
  const Json json = Json::parse(tested.out)["tests"].at(0);
  EXPECT_EQ(json["device"]["id"], gpu);
  EXPECT_EQ(json["device"]["test"], "passed");
  for (const char* key : {"name", "driver", "vulkan_version", "subgroup_size"})
    EXPECT_TRUE(json["device"].contains(key)) << key;
  EXPECT_GT(json["checks"].size(), 20u);
  for (const Json& check : json["checks"]) EXPECT_EQ(check["difference"], "") << check;
  EXPECT_TRUE(fs::exists(path("cache")));
  const Result listed = run("devices", cache);
  EXPECT_NE(listed.out.find("test: passed"), std::string::npos) << listed.out;
}

TEST_F(CliDevices, TestsNothingButGpus) {
  expectFailure("devices --test cpu", ErrorCode::Usage, "'cpu' is not the name of a GPU");
  expectFailure("devices --test vulkan:99", ErrorCode::Unsupported, "vulkan:99");
  const Result none = run("devices --test", "VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere");
  EXPECT_EQ(none.code, exitCode(ErrorCode::Unsupported));
  EXPECT_NE(none.err.find("there is no GPU to test: "), std::string::npos) << none.err;
}

TEST_F(CliDevices, SaysWhyThereIsNoGpu) {
  const Result result = run("devices --json", "VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere");
  EXPECT_EQ(result.code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["devices"][0]["chosen_by_auto"], true);
  EXPECT_EQ(json["devices"].size(), 1u);
  EXPECT_FALSE(json["note"].get<std::string>().empty());
}

}  // namespace
}  // namespace raymap
