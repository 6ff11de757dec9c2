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
  bool push(std::int64_t id, const std::string& slot) { return queue.push({{listener, id, "x", {}}, slot}); }
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
