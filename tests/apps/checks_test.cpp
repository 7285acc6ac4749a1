// Checks of options, files and sizes, before a command works.

#include <fstream>

#include "cli.h"

namespace raymap {
namespace {

class CliChecks : public Cli {};

TEST_F(CliChecks, RefusesBadOptions) {
  writeTorus();
  const auto refuse = [&](const std::string& options, const std::string& message) {
    expectFailure("generate torus.ply -o f.nrrd " + options, ErrorCode::Usage, message);
  };
  refuse("--resolution 0", "--resolution: must be a whole number from 1 to 2147483647, not 0");
  refuse("--resolution 64.5", "--resolution: must be a whole number");
  refuse("--resolution 3000000000", "--resolution: must be a whole number");
  refuse("--resolution many", "--resolution");
  refuse("--voxel-size 0", "--voxel-size");
  refuse("--voxel-size nan", "--voxel-size: must be a number above 0, not nan");
  refuse("--voxel-size 1 --resolution 3",
         "--voxel-size and --resolution cannot be used together; leave one of them out");
  refuse("--shape 8 8 8 --resolution 8",
         "--resolution and --shape cannot be used together; leave one of them out");
  refuse("--shape 8 8", "--shape takes 3 numbers, and here are 2");
  refuse("--shape 8 0 8", "--shape: must be a whole number from 1 to 2147483647, not 0");
  refuse("--shape 8 8 8.5", "--shape: must be a whole number from 1 to 2147483647, not 8.5");
  refuse("--bounds 0 0 0 1 1", "--bounds");
  refuse("--bounds 1 0 0 0 1 1", "--bounds: each of x0 y0 z0 must be less");
  refuse("--padding -1", "--padding");
  refuse("--band -3", "--band");
  refuse("--threshold 0", "--threshold");
  refuse("--passes 0", "--passes");
  refuse("--threads -1", "--threads");
  refuse("--distance roughly", "--distance");
  refuse("--sign none --winding w.npy", "--winding and --confidence need a sign");
  refuse("--distance raster --triangle-ids t.npy", "--triangle-ids needs another distance");
  refuse("--winding f.nrrd", "another option already writes this file");
  refuse("--winding w.txt", "must end in one of");
  refuse("--stats stats.txt", "must end in .json");
  refuse("--no-such-option 1", "not understood: --no-such-option; see raymap generate --help");
  expectFailure("generate torus.ply", ErrorCode::Usage,
                "--output FILE is required; see raymap generate --help");
  expectFailure("generate torus.ply -o f.txt", ErrorCode::Usage, ".nrrd");
  expectFailure("render torus.txt -o f.png", ErrorCode::File, "torus.txt: no such file");
  std::ofstream(path("text.txt")) << "text\n";
  expectFailure("render text.txt -o f.png", ErrorCode::Unsupported, ".obj .ply .stl");
  expectFailure("render text.txt -o f.png", ErrorCode::Unsupported, ".npz");
  fs::remove(path("text.txt"));
  expectFailure("render torus.ply -o f.png --index 3", ErrorCode::Usage,
                "--index needs --slice AXIS; add it");
  expectFailure("render torus.ply -o f.png --direction 0 1 0", ErrorCode::Usage, "--direction and --up");
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(CliChecks, ShowsLengthsThatAreShort) {
  writeTorus();
  expectFailure("repair torus.ply -o s.stl --voxel-size 0.25 --shell 1e-9", ErrorCode::Usage,
                "a wall of 1e-09 is thinner than two samples (0.5)");
  expectFailure("generate torus.ply -o f.nrrd --voxel-size 1e-12", ErrorCode::Usage,
                "at a spacing of 1e-12 needs");
  expectFailure("render torus.ply -o f.png --up 0 1e-320 0", ErrorCode::Usage, "--direction and --up");
}

TEST_F(CliChecks, ReadsSizesOfMemory) {
  writeTorus();
  const std::string generate = "generate torus.ply -o f.nrrd --resolution 32 --memory-limit ";
  for (const char* enough : {"1.5GB", "1e9", "'1.5 gb'", "2000000k", "0.5GiB", "300M", "94371840", "1T", "0"})
    succeed(generate + enough);
  const auto refuses = [&](const std::string& size, const std::string& limit) {
    expectFailure(generate + size, ErrorCode::Memory, ", but only " + limit + " may be used");
  };
  refuses("12", "12 bytes");
  refuses("1.5", "1 byte");
  refuses("1e3", "1000 bytes");
  refuses("0.5KB", "512 bytes");
  refuses("3.75k", "3 KiB");
  refuses("1e5B", "97 KiB");
  refuses("0.0001GiB", "104 KiB");
  refuses("0.1MB", "102 KiB");
  for (const char* wrong :
       {"much", "-1", "1.5XB", "GB", "1e", "nan", "inf", "1e30", "5000000T", "1.5GBs", "''"})
    expectFailure(generate + wrong, ErrorCode::Usage, "must be a size such as 500MB, 1.5GB or 1e9, not ");
}

TEST_F(CliChecks, NamesTheFileThatIsWrong) {
  writeTorus();
  std::ofstream(path("text.ply")) << "This is no mesh.\n";
  std::ofstream(path("text.nrrd")) << "This is no field.\n";
  expectFailure("info nothing.ply", ErrorCode::File, "nothing.ply");
  expectFailure("info text.ply", ErrorCode::Input, "text.ply");
  expectFailure("convert text.nrrd f.npz", ErrorCode::Input, "text.nrrd");
  expectFailure("generate torus.ply -o no/f.nrrd", ErrorCode::File, "there is no folder no");
  expectFailure("generate torus.ply -o f.nrrd --memory-limit 1MB --resolution 200", ErrorCode::Memory, "");
  EXPECT_FALSE(fs::exists(path("f.nrrd")));
}

TEST_F(CliChecks, ReplacesAnInputOnlyOnRequest) {
  writeTorus();
  const std::string before = readBytes(path("torus.ply"));
  fs::create_symlink("torus.ply", path("link.ply"));
  fs::create_hard_link(path("torus.ply"), path("twin.ply"));
  for (const char* command :
       {"repair torus.ply -o torus.ply", "repair torus.ply -o ./torus.ply", "repair torus.ply -o link.ply",
        "repair link.ply -o torus.ply", "repair torus.ply -o twin.ply", "mesh torus.ply -o torus.ply",
        "convert torus.ply torus.ply", "query torus.ply torus.ply -o link.ply"})
    expectFailure(command, ErrorCode::Usage, "to replace it: --overwrite");
  EXPECT_EQ(readBytes(path("torus.ply")), before);
  succeed("generate torus.ply -o torus.npy --resolution 8 --device cpu");
  expectFailure("convert torus.npy torus.npy", ErrorCode::Usage, "output torus.npy: is the input torus.npy");
  fs::create_hard_link(path("torus.ply"), path("field.nrrd"));
  expectFailure("generate torus.ply -o field.nrrd", ErrorCode::Usage, "to replace it: --overwrite");
  succeed("generate torus.ply -o field.nrrd --resolution 8 --device cpu --overwrite");
  succeed("convert torus.ply torus.ply --overwrite");
  succeed("mesh torus.ply -o torus.ply --resolution 32 --device cpu --overwrite");
  succeed("repair torus.ply -o torus.ply --overwrite");
  succeed("query torus.ply torus.ply -o link.ply --overwrite");
  EXPECT_NE(readBytes(path("torus.ply")), before);
}

}  // namespace
}  // namespace raymap
