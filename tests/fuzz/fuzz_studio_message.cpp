// Fuzzes the messages of pages. The input is one message; the scene that it meets is that of all messages before it. Every
// message is answered, in time, and by JSON.
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <pointskin/device.hpp>

#include "studio/session/studio.hpp"

using namespace pointskin;
using namespace pointskin::studio;

namespace {

class Page : public Client {
 public:
  void send(std::string json) override {
    const nlohmann::json message = nlohmann::json::parse(json);  // throws, and so ends the fuzzer, if it is none
    if (message.contains("event")) return;
    const std::lock_guard lock(mutex_);
    ++replies_;
    came_.notify_all();
  }
  [[nodiscard]] bool loopback() const override { return true; }
  [[nodiscard]] std::uint64_t id() const override { return 1; }

  /// Waits until there were so many replies.
  void expect_replies(std::uint64_t count) {
    std::unique_lock lock(mutex_);
    if (!came_.wait_for(lock, std::chrono::seconds(60), [&] { return replies_ >= count; })) std::abort();
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::uint64_t replies_ = 0;
};

/// The studio, which runs as long as the fuzzer, in an empty folder.
class Target {
 public:
  Target() : folder_(new_folder()), studio_(options(folder_)), page_(std::make_shared<Page>()) {
    studio_.opened(page_);
  }
  ~Target() {
    studio_.closed(1);
    std::filesystem::remove_all(folder_);
  }

  void try_out(std::string_view message) {
    studio_.message(page_, message);
    page_->expect_replies(++sent_);
  }

 private:
  static std::filesystem::path new_folder() {
    std::string form = (std::filesystem::temp_directory_path() / "pointskin-fuzz-XXXXXX").string();
    if (mkdtemp(form.data()) == nullptr) std::abort();
    return form;
  }

  static StudioOptions options(const std::filesystem::path& folder) {
    StudioOptions options;
    options.device = Device::cpu(1);
    options.roots = {folder};
    options.folder = folder;
    options.version = "fuzz";
    options.max_upload = 1 << 20;
    return options;
  }

  const std::filesystem::path folder_;
  Studio studio_;
  std::shared_ptr<Page> page_;
  std::uint64_t sent_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Target target;
  target.try_out({reinterpret_cast<const char*>(data), size});
  return 0;
}
