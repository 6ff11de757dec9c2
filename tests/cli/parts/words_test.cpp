// Command lines split into words: the rules, and that nothing else is special.
#include "bench/words.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

using Words = std::vector<std::string>;

TEST(SplitWords, BlanksSeparate) {
  EXPECT_EQ(split_words("PoissonRecon --in {in}  --depth\t8\n"),
            (Words{"PoissonRecon", "--in", "{in}", "--depth", "8"}));
  EXPECT_EQ(split_words("  a "), Words{"a"});
}

TEST(SplitWords, QuotesKeepBlanksAndMayBePartOfAWord) {
  EXPECT_EQ(split_words("'a b' \"c d\" e' 'f\" \"g"), (Words{"a b", "c d", "e f g"}));
  EXPECT_EQ(split_words("x '' \"\""), (Words{"x", "", ""}));
}

TEST(SplitWords, BackslashesKeepTheNextCharacterWhereTheyAreSpecial) {
  EXPECT_EQ(split_words(R"(a\ b \'c \\)"), (Words{"a b", "'c", "\\"}));
  EXPECT_EQ(split_words(R"('a\b' '\')"), (Words{"a\\b", "\\"}));
  EXPECT_EQ(split_words(R"("a\"b" "\\" "\n")"), (Words{"a\"b", "\\", "\\n"}));
}

TEST(SplitWords, NothingThatAShellKnowsIsSpecial) {
  EXPECT_EQ(split_words("p $HOME *; rm|x >y `z` $(w) #c"),
            (Words{"p", "$HOME", "*;", "rm|x", ">y", "`z`", "$(w)", "#c"}));
}

TEST(SplitWords, RefusesWhatEndsTooEarlyAndWhatIsEmpty) {
  for (const char* text : {"a 'b", "a \"b", "a \"b\\\"", "a\\", "", "  "}) {
    EXPECT_THROW(split_words(text), Error) << text;
  }
}

TEST(FillIn, ReplacesEveryNameWithoutSplittingTheWord) {
  EXPECT_EQ(fill_in({"p", "--in={in}", "{in}{depth}"}, {{"in", "a b'$(c).ply"}, {"depth", "8"}}),
            (Words{"p", "--in=a b'$(c).ply", "a b'$(c).ply8"}));
}

TEST(FillIn, LooksAtNoValueAgain) { EXPECT_EQ(fill_in({"{in}"}, {{"in", "{out}"}, {"out", "never"}}), Words{"{out}"}); }

TEST(FillIn, LeavesOtherBracesAndRefusesUnknownNames) {
  EXPECT_EQ(fill_in({"{", "{}", "{1,2}", "}", "{{in}"}, {{"in", "x"}}), (Words{"{", "{}", "{1,2}", "}", "{x"}));
  EXPECT_THROW(fill_in({"{input}"}, {{"in", "x"}}), Error);
}

TEST(Quoted, IsSplitBackIntoTheSameWords) {
  const Words words = {"a", "", "b c", "d'e", "f\"g", "h\\i", "$(j)", "--k=l"};
  EXPECT_EQ(quoted({"ls", "-l", "a b"}), "ls -l 'a b'");
  EXPECT_EQ(split_words(quoted(words)), words);
}

}  // namespace
}  // namespace pointskin::cli
