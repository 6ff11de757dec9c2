// The queue of the engine's jobs by itself: what is dropped, what is told to stop, and what never is.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/job_queue.hpp"

namespace pointskin {
namespace {

using namespace std::chrono_literals;
using studio::JobQueue;

class Listener : public studio::Client {
 public:
  void send(std::string json) override { messages.push_back(nlohmann::json::parse(json)); }
  [[nodiscard]] bool loopback() const override { return true; }
  [[nodiscard]] std::uint64_t id() const override { return 1; }
  std::vector<nlohmann::json> messages;
};

class SessionQueue : public testing::Test {
 protected:
  bool push(std::int64_t id, const std::string& slot, bool background = false) {
    return queue.push({{listener, id, "x", {}}, slot, background});
  }
  std::int64_t next() {
    const std::optional<JobQueue::Job> job = queue.next(0ms);
    return job ? job->request.id : -1;
  }

  std::shared_ptr<Listener> listener = std::make_shared<Listener>();
  JobQueue queue;
};

TEST_F(SessionQueue, ANewerRequestOfASlotDropsTheOlderBeforeItStarts) {
  push(1, "preview");
  push(2, "");
  push(3, "frame");
  push(4, "preview");
  ASSERT_EQ(listener->messages.size(), 1U);
  EXPECT_EQ(listener->messages[0].at("id"), 1);
  EXPECT_EQ(listener->messages[0].at("error").at("code"), "superseded");
  EXPECT_EQ(next(), 2);
  EXPECT_EQ(next(), 3);
  EXPECT_EQ(next(), 4);
  EXPECT_EQ(next(), -1);
}

TEST_F(SessionQueue, RequestsWithoutASlotAreAllDoneInTheirOrder) {
  for (std::int64_t id = 0; id < 10; ++id) push(id, "");
  for (std::int64_t id = 0; id < 10; ++id) EXPECT_EQ(next(), id);
  EXPECT_TRUE(listener->messages.empty());
}

TEST_F(SessionQueue, ARunningPreviewStopsForANewerOneAndForWhatCounts) {
  push(1, "preview");
  (void)next();
  EXPECT_FALSE(queue.should_stop());
  push(2, "frame");
  EXPECT_FALSE(queue.should_stop()) << "of another slot";
  push(3, "preview");
  EXPECT_TRUE(queue.should_stop());
  queue.finished();
  EXPECT_FALSE(queue.should_stop());
  (void)next();
  (void)next();
  EXPECT_FALSE(queue.should_stop());
  push(4, "");
  EXPECT_TRUE(queue.should_stop());
}

TEST_F(SessionQueue, WhatCountsRunsToItsEndUnlessItIsCancelled) {
  queue.cancel();
  push(1, "");
  (void)next();
  push(2, "");
  push(3, "preview");
  EXPECT_FALSE(queue.should_stop());
  queue.cancel();
  EXPECT_TRUE(queue.should_stop());
  queue.finished();
  EXPECT_EQ(next(), 2);
  EXPECT_FALSE(queue.should_stop()) << "the next one is not cancelled";
}

TEST_F(SessionQueue, TheBackgroundWaitsForAllOthersAndStopsForThem) {
  push(1, "measure", true);
  EXPECT_FALSE(queue.waiting()) << "for nothing that a person asked for";
  push(2, "preview");
  EXPECT_TRUE(queue.waiting());
  EXPECT_EQ(next(), 2);
  EXPECT_FALSE(queue.should_stop()) << "a preview does not make way for the background";
  EXPECT_EQ(next(), 1);
  push(3, "estimate", true);
  EXPECT_FALSE(queue.should_stop()) << "those of the background wait for each other";
  push(4, "preview");
  EXPECT_TRUE(queue.should_stop());
}

TEST_F(SessionQueue, WhatTheBackgroundBeganIsDoneLater) {
  push(1, "measure", true);
  const std::optional<JobQueue::Job> job = queue.next(0ms);
  ASSERT_TRUE(job);
  push(2, "");
  EXPECT_TRUE(queue.put_back(*job));
  queue.finished();
  EXPECT_EQ(next(), 2);
  EXPECT_EQ(next(), 1);
  push(5, "measure", true);
  EXPECT_FALSE(queue.put_back(*job)) << "a newer one waits";
  EXPECT_EQ(next(), 5);
  queue.cancel();
  EXPECT_FALSE(queue.put_back(*job)) << "it was cancelled";
  EXPECT_TRUE(listener->messages.empty());
}

TEST_F(SessionQueue, TooManyAreNotTaken) {
  for (std::size_t i = 0; i < JobQueue::kMostJobs; ++i) ASSERT_TRUE(push(static_cast<std::int64_t>(i), ""));
  EXPECT_FALSE(push(1'000, ""));
  (void)next();
  EXPECT_TRUE(push(1'001, ""));
}

TEST_F(SessionQueue, NothingIsTakenOrGivenAfterTheEnd) {
  push(1, "");
  queue.close();
  EXPECT_EQ(next(), -1);
  EXPECT_FALSE(push(2, ""));
  EXPECT_TRUE(queue.should_stop());
}

}  // namespace
}  // namespace pointskin
