#include <gtest/gtest.h>

#include <cmath>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::story_of;

std::vector<std::string> names_of(const Cloud& cloud) {
  std::vector<std::string> names;
  for (const Attribute& a : cloud.attributes) names.push_back(a.name);
  return names;
}

using Names = std::vector<std::string>;
const Names kColours{"red", "green", "blue"};

TEST(TextReader, TakesEverySeparatorCommentsBlankLinesAndSigns) {
  const Cloud cloud = cloud_of("a.xyz",
                               "\xEF\xBB\xBF# a comment\r\n1 2 3\r\n\r\n// another\n  4,5,6\n;7;8;9;\n"
                               "\t10\t11\t12 # tail\n+1.5, -2e0, 1e-5\n,,\n.5 5. 0");
  EXPECT_EQ(cloud.positions,
            (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}, {1.5f, -2, 1e-5f}, {0.5f, 5, 0}}));
}

TEST(TextReader, MeansByTheNumberOfColumns) {
  EXPECT_FALSE(cloud_of("a.xyz", "1 2 3\n").has_normals());
  EXPECT_EQ(names_of(cloud_of("a.xyz", "1 2 3 0.5\n")), Names{"scalar"});
  EXPECT_EQ(cloud_of("a.xyz", "1 2 3 0 0 1\n4 5 6 0 1 0\n").normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(names_of(cloud_of("a.xyz", "1 2 3 0 0 1\n4 5 6 0 2 0\n")), kColours);
  EXPECT_TRUE(cloud_of("a.xyz", "1 2 3 0 0 256\n").has_normals());
  EXPECT_EQ(names_of(cloud_of("a.pts", "1 2 3 -7.5 10 20 30\n")), (Names{"scalar", "red", "green", "blue"}));
  const Cloud nine = cloud_of("a.txt", "1 2 3 10 20 30 0 0 1\n");
  EXPECT_EQ(names_of(nine), kColours);
  EXPECT_EQ(nine.attributes[1].values.at(0), 20);
  EXPECT_EQ(nine.attributes[1].type(), AttributeType::uint8);
  EXPECT_EQ(nine.normals[0], (Vec3f{0, 0, 1}));
  const Cloud swapped = cloud_of("a.txt", "1 2 3 0.5 0 1 10 20 30\n");
  EXPECT_EQ(swapped.normals[0], (Vec3f{0.5f, 0, 1}));
  EXPECT_EQ(swapped.attributes[2].values.at(0), 30);
}

TEST(TextReader, RejectsColumnsWithoutAnAgreedMeaning) {
  for (const char* text : {"1 2\n", "1 2 3 4 5\n", "1 2 3 4 5 6 7 8\n", "1 2 3 4 0.5 0.5 0.5\n",
                           "1 2 3 0.1 0.2 0.3 0.4 0.5 0.6\n", "1 2 3 4 5 6 7 8 9 10\n", "1.5\n", "-3\n1 2 3\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.xyz", text); }), "") << text;
}

TEST(TextReader, TakesTheNamesOfTheFirstLineOrOfAComment) {
  for (const char* head :
       {"nx,ny,nz,X,Y,Z,\"point id\",R,G,B\n", "# nx,ny,nz,x,y,z,point id,r,g,b\n",
        "//nx;ny;nz;x;y;z;point id;Red;Green;Blue\n", "nx\tny\tnz\tx\ty\tz\tpoint id\tr\tg\tb\r\n"}) {
    const Cloud cloud = cloud_of("a.csv", std::string(head) + "0,0,1,7,8,9,42,1,2,3\n0,0,1,0,0,0,43,1,2,3\n");
    ASSERT_EQ(cloud.size(), 2) << head;
    EXPECT_EQ(cloud.positions[0], (Vec3f{7, 8, 9}));
    EXPECT_EQ(cloud.normals[0], (Vec3f{0, 0, 1}));
    EXPECT_EQ(names_of(cloud), (Names{"point id", "red", "green", "blue"})) << head;
    EXPECT_EQ(cloud.attributes[3].type(), AttributeType::uint8);
    EXPECT_EQ(cloud.attributes[0].type(), AttributeType::int32);
  }
}

TEST(TextReader, RejectsNamesThatDoNotFit) {
  for (const char* text : {"x,y,z\n1,2,3,4\n", "a,b,c\n1,2,3\n", "x,y,y\n1,2,3\n", "x,y,z\n", "x,y,z\nu,v,w\n1,2,3\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.csv", text); }), "") << text;
}

TEST(TextReader, ComparesTheCountOfPtsWithItsLines) {
  EXPECT_EQ(cloud_of("a.pts", "2\n1 2 3\n4 5 6\n").size(), 2);
  for (const char* text : {"3\n1 2 3\n4 5 6\n", "1\n1 2 3\n4 5 6\n", "1000000000000\n1 2 3\n", "2\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.pts", text); }), "") << text;
}

TEST(TextReader, NamesTheFirstBadLineForAnyNumberOfThreads) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += i == 150'000 || i == 190'000 ? "1 2 oops\n" : "1 2 3\n";
  for (const int threads : {1, 4}) {
    ReadOptions options;
    options.threads = threads;
    const std::string story = story_of(ErrorCode::invalid_input, [&] { cloud_of("a.xyz", text, options); });
    EXPECT_EQ(story, "a.xyz: 'oops' is not a number, line 150001; correct the line or export the file again");
  }
}

TEST(TextReader, RejectsLinesOfTheWrongLengthAndGarbledNumbers) {
  for (const char* line : {"4 5", "4 5 6 7", "4 5 6z", "4 5 --6", "4 5 +-6", "4 5 1e", "4 5 0x10", "4 5 -"}) {
    const std::string story =
        story_of(ErrorCode::invalid_input, [&] { cloud_of("a.xyz", std::string("1 2 3\n") + line + "\n"); });
    EXPECT_NE(story.find("line 2"), std::string::npos) << line << " " << story;
  }
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { cloud_of("a.xyz", "1 2 x3\n"); }).find("line 1"),
            std::string::npos);
}

TEST(TextReader, RejectsDecimalCommasInsteadOfSplittingThem) {
  for (const char* text : {"1,5;2,5;3,5\n", "1,5 2,5 3,5\n", "1,5\t2,5\t3,5\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.csv", text); }).find("decimal"), std::string::npos);
}

TEST(TextReader, DropsPointsThatAreNotFinite) {
  const Cloud cloud = cloud_of("a.xyz", "nan 0 0\n1 2 3\ninf 0 0\n0 -INF 0\n0 0 1e999\n4 5 1e-999\n0 1e39 0\n");
  EXPECT_EQ(cloud.dropped, 5);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 0}}));
}

TEST(TextReader, RejectsAFileWithoutPoints) {
  for (const char* text : {"", "\n\n", "# nothing\n", "x y z\n", "5\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.xyz", text); }).find("holds no points"),
              std::string::npos)
        << text;
}

TEST(TextReader, RejectsManyShortLinesUnderALongOneBeforeTakingMemory) {
  std::string names = "x,y,z";
  std::string first = "1,2,3";
  for (int i = 0; i < 10'000; ++i) {
    names += ",c" + std::to_string(i);
    first += ",4";
  }
  std::string text = names + "\n" + first + "\n";
  for (int i = 0; i < 1'000'000; ++i) text += "1\n";
  EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.csv", text); }), "");  // else 40 GB
}

TEST(TextReader, IsLinearInAFileWithoutLineEnds) {
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { cloud_of("a.xyz", std::string(64 << 20, '1')); }), "");
}

TEST(TextReader, GivesTheSameCloudForAnyNumberOfThreads) {
  std::string text;
  for (int i = 0; i < 100'000; ++i)
    text += std::to_string(1e6 + i * 0.001) + " " + (i % 11 == 0 ? "nan" : std::to_string(i)) + " 7 0 0 1\n";
  ReadOptions one;
  one.threads = 1;
  ReadOptions four;
  four.threads = 4;
  const Cloud a = cloud_of("a.xyz", text, one);
  const Cloud b = cloud_of("a.xyz", text, four);
  EXPECT_EQ(a.dropped, 9091);  // 0, 11, ..., 99990
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.origin, b.origin);
}

TEST(TextReader, KeepsTheMillimetresOfSurveyCoordinates) {
  const Cloud cloud = cloud_of("a.xyz", "2600000.001 1200000.002 400.003\n2600001.004 1200001.005 401.006\n");
  EXPECT_EQ(cloud.origin, (Vec3d{2600001, 1200001, 401}));
  EXPECT_NEAR(cloud.origin[0] + cloud.positions[0].x, 2600000.001, 1e-6);
  EXPECT_NEAR(cloud.origin[1] + cloud.positions[1].y, 1200001.005, 1e-6);
}

TEST(TextReader, EndsInAnAnswerOrAnErrorForEveryDamage) {
  ReadOptions options;
  options.threads = 1;
  EXPECT_NO_THROW(test::damage("2\nx,y,z,nx,ny,nz\n1,2,3,0,0,1\n4.5,-5e1,+6,0,1,0\n",
                               [&](const std::string& b) { cloud_of("a.csv", b, options); }));
  EXPECT_NO_THROW(test::damage("#x y z s r g b\r\n1 2 3 4 10 20 30\n1 2 3 4 10 20 nan",
                               [&](const std::string& b) { cloud_of("-", b, options); }));
}

TEST(CloudReader, TellsWhatIsWrongWithAPath) {
  const test::TemporaryFolder folder;
  const auto story = [](const std::string& path) {
    return story_of(ErrorCode::invalid_input, [&] { read_cloud(path); });
  };
  test::make_file(folder.file("empty.xyz"), "");
  test::make_file(folder.file("cloud.docx"), "1 2 3\n");
  EXPECT_NE(story(folder.file("none.xyz")).find("No such file"), std::string::npos);
  EXPECT_NE(story(folder.file("")).find("is a folder"), std::string::npos);
  EXPECT_NE(story(folder.file("empty.xyz")).find("is empty"), std::string::npos);
  EXPECT_NE(story(folder.file("cloud.docx")).find("'.docx'"), std::string::npos);
  EXPECT_EQ(story(folder.file("two\nlines.xyz")).find('\n'), std::string::npos);
}

TEST(CloudReader, ReadsFilesWithoutAnExtensionByTheirContentAndMeshesByTheirVertices) {
  const test::TemporaryFolder folder;
  test::make_file(folder.file("cloud"), "1 2 3\n0 0 0\n");
  test::make_file(folder.file("mesh.OFF"), "OFF\n2 0 0\n1 2 3\n4 5 6\n");
  EXPECT_EQ(read_cloud(folder.file("cloud")).positions, (std::vector<Vec3f>{{1, 2, 3}, {0, 0, 0}}));
  EXPECT_EQ(read_cloud(folder.file("mesh.OFF")).size(), 2);
}

TEST(BoundsOf, IsTheSmallestBoxAndZeroForNoPoints) {
  EXPECT_EQ(bounds_of({}).lower, (Vec3f{0, 0, 0}));
  const Bounds bounds = bounds_of({{1, -2, 3}, {-4, 5, 6}});
  EXPECT_EQ(bounds.lower, (Vec3f{-4, -2, 3}));
  EXPECT_EQ(bounds.upper, (Vec3f{1, 5, 6}));
}

}  // namespace
}  // namespace pointskin
