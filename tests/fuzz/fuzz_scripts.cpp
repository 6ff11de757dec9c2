// Fuzzes what reads the scripts of `edit` and `deform`: any bytes are a script, or an Error of invalid input.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <pointskin/error.hpp>

#include "scene/deform_script.hpp"
#include "scene/document.hpp"

using namespace pointskin;

namespace {

template <class Read>
void read(const Read& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_input) std::abort();
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();  // one line
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read([&] { (void)scene::parse_deformation(text, "bend.json"); });
  read([&] {
    const scene::Document document = scene::parse_document(text, "edits.json", "/scene");
    (void)scene::to_json(document, "/scene").dump();
  });
  return 0;
}
