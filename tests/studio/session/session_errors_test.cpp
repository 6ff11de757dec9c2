// Wrong messages: each is answered with an error in one line, and nothing else happens.
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

using test::Json;
using test::lift;
using test::Refused;
using test::StudioTest;

const std::set<std::string> kCodes = {"usage",      "invalid_input",      "no_normals",         "empty_result",
                                      "over_limit", "device_unavailable", "output_not_written", "interrupted",
                                      "superseded"};

class SessionErrors : public StudioTest {
 protected:
  /// The text of the error. Fails if there is none, or none that a page can show.
  std::string error(const std::string& what, const Json& body) {
    try {
      (void)page().ask(what, body);
      ADD_FAILURE() << what << " " << body.dump() << " was done";
      return "";
    } catch (const Refused& refused) {
      const std::string text = refused.what();
      EXPECT_TRUE(kCodes.contains(refused.code())) << what << " " << body.dump() << ": " << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text;
    }
  }
};

/// Values of every JSON type but the one that is wanted somewhere.
std::vector<Json> odd_values() {
  return {nullptr, true, -1, 1e308, "", "x", Json::array(), Json::array({1}), Json::object(), {{"x", 1}}};
}

const std::vector<std::pair<std::string, std::string>>& required_keys() {
  static const std::vector<std::pair<std::string, std::string>> keys = {
      {"open", "files"},    {"resume", "path"},       {"apply", "operation"}, {"preview", "operation"},
      {"go", "done"},       {"options", "patch"},     {"ack", "version"},     {"files", "folder"},
      {"save", "what"},     {"compare", "reference"}, {"pick", "origin"},     {"fluid", "start"},
      {"sequence", "path"}, {"frame", "index"},       {"values", "name"},     {"operation", "index"}};
  return keys;
}

TEST_F(SessionErrors, WhatIsNoRequestIsAnsweredAllTheSame) {
  start();
  const std::vector<std::string> texts = {"",
                                          "{",
                                          "[]",
                                          "3",
                                          "null",
                                          "\"hello\"",
                                          R"({"do": "hello"})",
                                          R"({"id": 1.5, "do": "hello"})",
                                          R"({"id": -1, "do": "hello"})",
                                          R"({"id": 1e300, "do": "hello"})",
                                          R"({"id": 1000000})",
                                          R"({"id": 1000000, "do": 2})",
                                          R"({"id": 18446744073709551615, "do": "hello"})",
                                          "{\"id\": 1000000, \"do\": \"\xff\"}",
                                          R"({"id": 1000000, "do": "fly"})"};
  for (const std::string& text : texts) {
    const std::size_t before = page().messages().size();
    page().send_text(text);
    const std::vector<Json> messages = page().messages();
    ASSERT_EQ(messages.size(), before + 1) << text;
    EXPECT_EQ(messages.back().at("error").at("code"), "usage") << text;
  }
  EXPECT_EQ(page().ask("hello").at("program"), "pointskin");
}

TEST_F(SessionErrors, DeepNestingIsRefused) {
  open_shape();
  for (const std::size_t depth : {100U, 10'000U, 400'000U}) {
    const std::string nested = std::string(depth, '[') + std::string(depth, ']');
    for (const std::string what :
         {R"("options", "final": true, "patch": {"depth": )", R"("apply", "operation": {"op": )"}) {
      const std::size_t before = page().messages().size();
      page().send_text(R"({"id": 1000000, "do": )" + what + nested + "}}");
      (void)page().ask("ack", {{"version", 0}});
      (void)page().ask("digest");
      const std::vector<Json> messages = page().messages();
      ASSERT_GT(messages.size(), before + 1);
      bool is_refused = false;
      for (std::size_t i = before; i < messages.size(); ++i) is_refused |= messages[i].contains("error");
      EXPECT_TRUE(is_refused) << depth;
    }
  }
}

TEST_F(SessionErrors, EveryRequestRefusesUnknownKeysAndMissingOnes) {
  open_shape();
  for (const auto& [what, key] : required_keys()) {
    if (what != "fluid" && what != "sequence" && what != "save") error(what, Json::object());
    EXPECT_NE(error(what, {{"colour", "red"}}).find(what), std::string::npos) << what;
  }
  for (const char* what : {"hello", "undo", "redo", "preview_end", "cancel", "digest", "problems", "histogram",
                           "reference_end", "values_end"})
    EXPECT_NE(error(what, {{"colour", "red"}}).find("colour"), std::string::npos) << what;
}

TEST_F(SessionErrors, EveryRequestRefusesOddValues) {
  open_shape();
  const std::string before = digest();
  for (const auto& [what, key] : required_keys())
    for (const Json& value : odd_values()) {
      const bool is_text = value.is_string() && (what == "files" || what == "ack");
      const bool is_nothing = value == Json::object() && (what == "fluid" || what == "options");  // all as it is
      if (!is_text && !is_nothing) error(what, {{key, value}});
    }
  EXPECT_EQ(digest(), before);
}

TEST_F(SessionErrors, WithoutASceneTheAnswerSaysSo) {
  start();
  const Json nothing = Json::object();
  const std::vector<std::pair<std::string, Json>> requests = {
      {"apply", {{"operation", lift(0.1)}}},
      {"undo", nothing},
      {"redo", nothing},
      {"go", {{"done", 0}}},
      {"preview", {{"operation", lift(0.1)}}},
      {"options", {{"patch", {{"depth", 5}}}}},
      {"digest", nothing},
      {"problems", nothing},
      {"histogram", nothing},
      {"estimate", nothing},
      {"values", {{"name", "density"}}},
      {"compare", {{"reference", {{"shape", "torus"}}}}},
      {"pick", {{"origin", {0, 0, 3}}, {"direction", {0, 0, -1}}}},
      {"save", {{"what", "mesh"}, {"name", "a.ply"}}}};
  for (const auto& [what, body] : requests)
    EXPECT_NE(error(what, body).find("there is no scene yet"), std::string::npos) << what;
  EXPECT_EQ(page().ask("hello").at("scene"), nullptr);
}

TEST_F(SessionErrors, OperationsOutOfRangeLeaveTheSceneAsItIs) {
  open_shape();
  const std::string before = digest();
  const std::vector<Json> operations = {
      {{"op", "options"}, {"depth", 99}},
      {{"op", "options"}},
      {{"op", "options"}, {"depth", "eight"}},
      {{"op", "guide"}, {"camera", test::front_camera()}},
      {{"op", "remove"}, {"camera", {{"view", {1}}}}, {"rectangle", {0, 0, 1, 1}}},
      {{"op", "deform"}, {"handles", {{{"region", {{"ball", {{"centre", {0, 0, 0}}, {"radius", -1}}}}}}}}},
      {{"op", "boolean"}, {"operation", "union"}, {"with", {{"shape", "dragon"}}}},
      {{"op", "boolean"}, {"operation", "union"}, {"with", {{"file", "/etc/passwd"}}}},
      {{"op", "insert"}, {"file", "../outside.ply"}},
      {{"op", "undo"}},
      {{"op", "paint"}}};
  for (const Json& operation : operations) {
    error("apply", {{"operation", operation}});
    error("preview", {{"operation", operation}});
  }
  EXPECT_TRUE(fresh_scene().at("history").empty());
  EXPECT_EQ(digest(), before);
}

TEST_F(SessionErrors, RemovingAllPointsIsRefused) {
  open_shape();
  error("apply", {{"operation", test::in_rectangle("remove", {0, 0}, {200, 200})}});
  EXPECT_EQ(fresh_scene().at("points"), 6'000);
}

}  // namespace
}  // namespace pointskin
