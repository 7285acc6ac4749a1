#include <fstream>
#include <sstream>

#include "cli.h"

namespace raymap {
namespace {

class CliQuery : public Cli {};

TEST_F(CliQuery, MeasuresPoints) {
  writeTorus();
  std::ofstream(path("p.csv")) << "name,x,y,z\nin,2,0,0\nout,0,0,0\nlost,nan,0,0\n";
  const Result result = succeed("query torus.ply p.csv -o r.csv --arrays triangle,distance --stats s.json");
  EXPECT_NE(result.out.find("p.csv: 3 points, 1 not finite"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(", 1 point inside"), std::string::npos) << result.out;
  std::istringstream rows(readBytes(path("r.csv")));
  std::string header, in, out, lost;
  for (std::string* row : {&header, &in, &out, &lost}) std::getline(rows, *row);
  EXPECT_EQ(header, "x,y,z,distance,triangle");
  EXPECT_EQ(in.rfind("2,0,0,-0.6", 0), 0u) << in;
  EXPECT_EQ(out.rfind("0,0,0,1.", 0), 0u) << out;
  EXPECT_EQ(lost, "nan,0,0,nan,-1");
  const Json stats = json("s.json");
  EXPECT_EQ(stats["points"]["count"], 3);
  EXPECT_EQ(stats["points"]["non_finite"], 1);
  EXPECT_EQ(stats["options"]["arrays"], Json({"distance", "triangle"}));
  EXPECT_TRUE(stats["options"]["max_distance"].is_null());
  EXPECT_EQ(stats["distances"]["inside"], 1);
  EXPECT_EQ(stats["stats"]["turned_faces"], 0);
}

TEST_F(CliQuery, MeasuresPointsWithoutASign) {
  writeTorus();
  std::ofstream(path("p.xyz")) << "2 0 0\n0 0 0\n";
  succeed("query torus.ply p.xyz -o r.csv --unsigned --max-distance 1 --stats s.json");
  const std::string rows = readBytes(path("r.csv"));
  EXPECT_EQ(rows.rfind("x,y,z,distance\n2,0,0,0.6", 0), 0u) << rows;
  EXPECT_NE(rows.find("\n0,0,0,1\n"), std::string::npos) << rows;
  EXPECT_EQ(json("s.json")["options"]["max_distance"], 1.0);
  EXPECT_EQ(json("s.json")["stats"]["doubtful_share"], 0.0);
}

TEST_F(CliQuery, CountsAnswersThatAreClamped) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(8.0)));
  // Two points beyond the band, one of them inside, one in the band, one on it, one outside of the grid.
  std::ofstream(path("p.csv")) << "4,4,4\n4,4,10.5\n4,4,8.5\n4,4,8\n4,4,99\n";
  const std::string grid = " --voxel-size 1 --bounds -4 -4 -4 12 12 12 --device cpu -q";
  const auto clamped = [&](const std::string& file, const std::string& band) {
    succeed("generate box.ply -o " + file + grid + band);
    const Result result = run("query " + file + " p.csv -o r.csv --stats s.json");
    const std::string text =
        "p.csv: " + std::to_string(json("s.json")["points"]["clamped"].get<int>()) +
        " of 5 points are beyond the distance to which the field is clamped; their distances "
        "are lower bounds. A field with a wider band, or the mesh itself, has the true ones\n";
    EXPECT_EQ(result.err.find(text) != std::string::npos, json("s.json")["points"]["clamped"] > 1)
        << result.err;
    EXPECT_EQ(json("s.json")["points"]["outside"], 1);
    return json("s.json")["points"]["clamped"].get<int>();
  };
  for (const std::string file : {"f.npz", "f.vdb", "f.nrrd"})
    EXPECT_EQ(clamped(file, " --band 2"), 2) << file;
  EXPECT_EQ(clamped("f.npz", " --band 3"), 1);  // Deep inside.
  EXPECT_NE(run("query f.npz p.csv -o r.csv").err.find("1 of 5 points is beyond the distance to which"),
            std::string::npos);
  EXPECT_EQ(clamped("g.npz", ""), 0);
  EXPECT_EQ(clamped("g.vdb", " --band 9"), 0);
}

TEST_F(CliQuery, ColoursAPointCloud) {
  writeTorus();
  succeed("query torus.ply torus.ply -o r.ply --colour");
  const std::string bytes = readBytes(path("r.ply"));
  EXPECT_NE(bytes.find("element vertex 960\n"), std::string::npos);
  EXPECT_NE(bytes.find("property float distance\nproperty uchar red\n"), std::string::npos);
  EXPECT_EQ(readPoints(path("r.ply")).size(), 960u);
}

TEST_F(CliQuery, RefusesQueriesThatMakeNoSense) {
  writeTorus();
  std::ofstream(path("p.csv")) << "1,2,3\n1,2\n";
  const auto usage = ErrorCode::Usage;
  expectFailure("query torus.ply p.csv -o r.csv", ErrorCode::Input,
                "p.csv: line 2: 2 columns, but line 1 has 3");
  expectFailure("query torus.ply p.csv -o r.txt", usage, "the name must end in one of .csv .npy .npz .ply");
  succeed("convert torus.ply torus.stl");
  expectFailure("query torus.ply torus.stl -o r.csv", usage, "'.stl' is not a format for points");
  fs::remove(path("torus.stl"));
  expectFailure("query torus.ply p.csv -o r.npy --arrays distance,closest", usage, "a .npy holds one array");
  expectFailure("query torus.ply p.csv -o r.csv --colour", usage, "--colour needs");
  expectFailure("query torus.ply p.csv -o r.ply --colour --arrays winding", usage, "--colour needs");
  expectFailure("query torus.ply p.csv -o r.csv --unsigned --arrays winding", usage, "leave out --unsigned");
  expectFailure("query torus.ply p.csv -o r.csv --arrays length", usage, "must be one of distance, closest");
  expectFailure("query torus.ply p.csv -o r.csv --max-distance 0", usage, "must be a number above 0");
  EXPECT_EQ(fileCount(), 2u);
}

TEST_F(CliQuery, SamplesFields) {
  Field field;
  field.grid = {{3, 3, 3}, {0, 0, 0}, 0.5};
  field.distance.resizeUninitialized(27);
  for (size_t i = 0; i < 27; ++i) field.distance[i] = 0.5F * float(i % 3) - 0.75F;
  writeField(path("f.npz"), field);
  std::ofstream(path("p.csv")) << "0.25,0.5,1\n1,0,0\n4,0,0\ninf,0,0\n";
  const Result result = run("query f.npz p.csv -o r.csv --arrays distance,gradient --stats s.json");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(
      result.err,
      "raymap: warning: p.csv: 1 of 4 points lies outside of the grid; their distances are lower bounds, and "
      "their gradients lead away from it\n");
  EXPECT_NE(result.out.find("f.npz: 27 samples\np.csv: 4 points, 1 not finite\n"), std::string::npos)
      << result.out;
  std::istringstream rows(readBytes(path("r.csv")));
  std::string header, between, corner;
  for (std::string* row : {&header, &between, &corner}) std::getline(rows, *row);
  EXPECT_EQ(header, "x,y,z,distance,gradient_x,gradient_y,gradient_z");
  EXPECT_EQ(between.rfind("0.25,0.5,1,-0.5,", 0), 0u) << between;
  EXPECT_EQ(corner.rfind("1,0,0,0.25,", 0), 0u) << corner;
  EXPECT_EQ(json("s.json")["points"]["outside"], 1);
  EXPECT_EQ(json("s.json")["distances"]["inside"], 1);
  std::ofstream(path("in.csv")) << "0,0,0\n1,1,1\n";
  succeed("query f.npz in.csv -o g.npy --arrays gradient");
  EXPECT_EQ(readPoints(path("g.npy")).size(), 2u);
  succeed("query f.npz in.csv -o c.ply --colour");
  succeed("query f.npz in.csv -o scaled.csv --scale 2");
  EXPECT_NE(readBytes(path("scaled.csv")).find("0,0,0,-1.5\n1,1,1,-0.5\n"), std::string::npos)
      << readBytes(path("scaled.csv"));
}

TEST_F(CliQuery, RefusesWhatAFieldLacks) {
  writeTorus();
  succeed("generate torus.ply -o t.npz --winding w.npz --resolution 8");
  std::ofstream(path("p.csv")) << "0,0,0\n";
  const auto usage = ErrorCode::Usage;
  for (const char* command : {"query w.npz p.csv -o r.csv", "mesh w.npz -o r.ply"})
    expectFailure(command, usage, "w.npz: it holds the array 'winding', and no distances");
  expectFailure("query t.npz p.csv -o r.csv --arrays closest", usage,
                "the array closest is one of meshes, and t.npz is a field");
  for (const char* option : {"--unsigned", "--threshold 0.4", "--orientation keep", "--max-distance 1"})
    expectFailure(std::string("query t.npz p.csv -o r.csv ") + option, usage,
                  " is for meshes, and t.npz is a field");
  expectFailure("query torus.ply p.csv -o r.csv --arrays gradient", usage,
                "the array gradient is one of fields, and torus.ply is a mesh");
  expectFailure("query t.npz p.csv -o r.npy --arrays distance,gradient", usage, "a .npy holds one array");
  EXPECT_EQ(fileCount(), 4u);
}

TEST_F(CliQuery, AnswersNoPoints) {
  writeTorus();
  succeed("generate torus.ply -o t.npz --resolution 8");
  std::ofstream(path("none.csv")) << "x,y,z\n";
  for (const char* from : {"torus.ply", "t.npz"}) {
    const Result result = succeed("query " + std::string(from) + " none.csv -o r.csv");
    EXPECT_NE(result.out.find("none.csv: 0 points\n"), std::string::npos) << result.out;
    EXPECT_EQ(readBytes(path("r.csv")), "x,y,z,distance\n");
    succeed("query " + std::string(from) + " none.csv -o r.ply --colour");
    EXPECT_TRUE(readPoints(path("r.ply")).empty());
  }
  succeed("query torus.ply none.csv -o r.csv --arrays closest,triangle");
  EXPECT_EQ(readBytes(path("r.csv")), "x,y,z,closest_x,closest_y,closest_z,triangle\n");
  succeed("query t.npz none.csv -o r.npy --arrays gradient");
  EXPECT_TRUE(readPoints(path("r.npy")).empty());
}

}  // namespace
}  // namespace raymap
