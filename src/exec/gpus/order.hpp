// The order of work on several GPUs as if they were one stream. Nothing here needs a GPU.
#pragma once

namespace pointskin::exec::gpus {

/// What waits for what. Work is the lead's alone (GPU 0 of the group), or everybody's at once; each piece sees all that was
/// enqueued before it. `Marks` are the group's events: record(g) marks what GPU g has been given so far, and wait(g, other) makes
/// what GPU g is given from now on wait for the mark that GPU `other` made last.
class Order {
 public:
  explicit Order(int count) : count_(count) {}

  /// What follows is the lead's alone.
  template <class Marks>
  void to_lead(Marks& marks) {
    if (!spread_) return;
    for (int other = 1; other < count_; ++other) marks.wait(0, other);
    spread_ = false;
  }

  /// One piece follows for every GPU at most, after which each makes its mark: record(g).
  template <class Marks>
  void to_all(Marks& marks) {
    marks.record(0);  // also of memory that was allocated in the order of the lead's stream
    if (!spread_) {
      for (int g = 1; g < count_; ++g) marks.wait(g, 0);
      spread_ = true;
      return;
    }
    for (int g = 0; g < count_; ++g)
      for (int other = 0; other < count_; ++other)
        if (other != g) marks.wait(g, other);
  }

 private:
  int count_;
  bool spread_ = false;  // the last work was everybody's
};

}  // namespace pointskin::exec::gpus
