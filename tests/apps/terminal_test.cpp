// Names of files that hold other bytes than text.

#include "cli.h"

namespace raymap {
namespace {

class CliTerminal : public Cli {};

TEST_F(CliTerminal, WritesNamesThatAreNoText) {
  writeTorus();
  const std::string name = "t\xff.ply";
  fs::rename(path("torus.ply"), path(name));
  EXPECT_EQ(shell("$R generate $'t\\xff.ply' -o f.nrrd --resolution 8 --stats s.json --report r.json").code,
            0);
  EXPECT_EQ(json("s.json")["mesh"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(json("r.json")["mesh"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(shell("$R repair $'t\\xff.ply' -o s.stl --resolution 16 --stats s.json").code, 0);
  EXPECT_EQ(json("s.json")["mesh"], "t\xef\xbf\xbd.ply");
  EXPECT_EQ(shell("$R query $'t\\xff.ply' $'t\\xff.ply' -o r.csv --stats s.json").code, 0);
  EXPECT_EQ(json("s.json")["points"]["file"], "t\xef\xbf\xbd.ply");
}

TEST_F(CliTerminal, EscapesWhatTurnsText) {
  // Each escaped character stands between neighbours that are shown.
  const std::string err =
      shell(
          "$R info $'"
          "\\xc2\\x80\\xc2\\xa0\\xd8\\x9b\\xd8\\x9c\\xd8\\x9d\\xe2\\x80\\x8d\\xe2\\x80\\x8e\\xe2\\x80\\x90"
          "\\xe2\\x80\\xa7\\xe2\\x80\\xa8\\xe2\\x80\\xae\\xe2\\x80\\xaf\\xe2\\x81\\xa5\\xe2\\x81\\xa6\\xe2\\x"
          "81\\xa9"
          "\\xe2\\x81\\xaa\\x9b\\xf0\\x9f\\x98\\x80.ply'")
          .err;
  const std::string shown =
      "\\xc2\\x80\xc2\xa0\xd8\x9b\\xd8\\x9c\xd8\x9d\xe2\x80\x8d\\xe2\\x80\\x8e\xe2\x80\x90"
      "\xe2\x80\xa7\\xe2\\x80\\xa8\\xe2\\x80\\xae\xe2\x80\xaf\xe2\x81\xa5\\xe2\\x81\\xa6\\xe2\\x81\\xa9"
      "\xe2\x81\xaa\\x9b\xf0\x9f\x98\x80.ply";
  EXPECT_NE(err.find(shown), std::string::npos) << err;
}

TEST_F(CliTerminal, SendsNoControlCharactersOfFileNamesToTheTerminal) {
  writeTorus();
  const std::string name = "t\x1b[31m\n\x7f\xc2\x9b\\'.ply",
                    quoted = "$'t\\x1b[31m\\n\\x7f\\xc2\\x9b\\\\\\'.ply'";
  const std::string shown = "t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\'.ply";
  Mesh torn = readMesh(path("torus.ply"));
  torn.triangles.pop_back();
  writeMesh(path(name), torn);
  const auto expectPlain = [&](const Result& result, int code) {
    const std::string text = result.out + result.err;
    EXPECT_EQ(result.code, code) << text;
    EXPECT_NE(text.find(shown), std::string::npos) << text;
    for (size_t i = 0; i < text.size(); ++i)
      EXPECT_TRUE(text[i] == '\n' || (static_cast<unsigned char>(text[i]) >= 0x20 && text[i] != '\x7f'))
          << text;
    EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos) << text;
    EXPECT_EQ(text.find(".ply\n'"), std::string::npos) << text;
  };
  expectPlain(shell("$R generate " + quoted + " -o f.nrrd --resolution 8 --device cpu"), 0);
  expectPlain(shell("$R query " + quoted + " " + quoted + " -o " + quoted + " --overwrite"), 0);
  expectPlain(shell("$R info gone_" + quoted), exitCode(ErrorCode::File));
  expectPlain(shell("$R generate " + quoted + " -o " + quoted), exitCode(ErrorCode::Usage));
  expectPlain(shell("$R --gone" + quoted), exitCode(ErrorCode::Usage));
  writeMesh(path(name), torn);  // The query has written its results there.
  const Result info = shell("$R info " + quoted);
  const size_t command = info.out.find("raymap repair ");
  ASSERT_NE(command, std::string::npos) << info.out;
  // The shown command works in bash as it stands.
  std::string line = info.out.substr(command, info.out.find('\n', command) - command);
  EXPECT_EQ(line,
            "raymap repair $'t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\\\\\'.ply' -o "
            "$'t\\x1b[31m\\x0a\\x7f\\xc2\\x9b\\\\\\'.solid.ply'");
  expectPlain(shell(line.replace(0, 6, "$R")), 0);
  EXPECT_EQ(fs::exists(path("t\x1b[31m\n\x7f\xc2\x9b\\'.solid.ply")), true);
  // Other characters stay as they are.
  fs::rename(path(name), path("t\xc3\xa9 \xe2\x82\xac \xff.ply"));
  EXPECT_NE(
      shell("$R generate $'t\\xc3\\xa9 \\xe2\\x82\\xac \\xff.ply' -o f.nrrd --resolution 8 --device cpu")
          .out.find("t\xc3\xa9 \xe2\x82\xac \xff.ply: "),
      std::string::npos);
}

}  // namespace
}  // namespace raymap
