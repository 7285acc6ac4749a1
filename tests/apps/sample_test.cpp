#include <sstream>

#include "cli.h"

namespace raymap {
namespace {

class CliSample : public Cli {};

TEST_F(CliSample, WritesThePointsOfTheLibrary) {
  writeTorus();
  const Result result = succeed(
      "sample torus.ply -o p.csv -n 200 --near 0.5 --surface 0.1 --sigma 0.1,0.01 --seed 7 --normalize");
  const PointSamples samples = samplePoints(Surface(readMesh(path("torus.ply"))), {.count = 200,
                                                                                   .surfaceShare = 0.1,
                                                                                   .nearShare = 0.5,
                                                                                   .sigmas = {0.1, 0.01},
                                                                                   .seed = 7,
                                                                                   .normalize = true});
  const std::vector<glm::dvec3> points = readPoints(path("p.csv"));
  ASSERT_EQ(points.size(), 200u);
  for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i], samples.points[i]);
  std::istringstream rows(readBytes(path("p.csv")));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "x,y,z,distance,gradient_x,gradient_y,gradient_z");
  for (size_t i = 0; std::getline(rows, row); ++i) {
    std::istringstream cells(row);
    std::vector<double> numbers;
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
    ASSERT_EQ(numbers.size(), 7u);
    EXPECT_EQ(numbers[3], samples.distance[i]);
    EXPECT_EQ(glm::dvec3(numbers[4], numbers[5], numbers[6]), samples.gradient[i]);
  }
  const auto inside = std::ranges::count_if(samples.distance, [](double d) { return d < 0.0; });
  EXPECT_NE(result.out.find("200 points, " + std::to_string(inside) + " inside\n"), std::string::npos);
  EXPECT_NE(result.out.find("then scaled by 0.37037"), std::string::npos) << result.out;
}

TEST_F(CliSample, WritesArraysAndPointClouds) {
  writeTorus();
  succeed("sample torus.ply -o p.npz -n 100");
  const std::string bytes = readBytes(path("p.npz"));
  for (const char* name : {"pos.npy", "neg.npy", "centre.npy", "scale.npy"})
    EXPECT_NE(bytes.find(name), std::string::npos) << name;
  succeed("sample torus.ply -o p.ply -n 100 --surface 1 --near 0");
  EXPECT_EQ(readPoints(path("p.ply")).size(), 100u);
  EXPECT_NE(readBytes(path("p.ply")).find("property float gradient_z\n"), std::string::npos);
  const Result piped = run("sample torus.ply -o - --format csv -n 3");
  EXPECT_EQ(std::ranges::count(piped.out, '\n'), 4);
}

TEST_F(CliSample, RefusesWhatMakesNoSense) {
  writeTorus();
  const auto usage = ErrorCode::Usage;
  expectFailure("sample torus.ply -o p.txt", usage, "the name must end in one of .npz .csv .ply");
  expectFailure("sample torus.ply -o p.npz --near 1.5", usage, "near must be a share from 0 to 1, not 1.5");
  expectFailure("sample torus.ply -o p.npz --near 0.9 --surface 0.2", usage, "at most 1 together");
  expectFailure("sample torus.ply -o p.npz --sigma -1", usage, "sigma must be numbers from 0 on, not -1");
  expectFailure("sample torus.ply -o p.npz -n -5", usage, "--count");
  expectFailure("sample torus.ply -o p.npz --seed -1", usage, "--seed");
  expectFailure("sample torus.ply -o torus.ply", usage, "--overwrite");
  EXPECT_EQ(fileCount(), 1u);
}

}  // namespace
}  // namespace raymap
