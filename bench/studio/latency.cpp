// What a client of a running studio waits for: strokes, a bend and live water, until their meshes are decoded.
//
//     pointskin_studio_latency URL [--strokes N] [--moves N] [--frames N] [--particles N]
//
// URL is the line that `pointskin studio CLOUD --no-browser` prints. Prints medians and 95th percentiles.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "connection.hpp"
#include "mesh_blob.hpp"

namespace pointskin::bench {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Between strokes, as of a person who is quick.
constexpr std::chrono::milliseconds kPause{300};

struct Box {
  double lower[3], upper[3];
};

void print_times(const char* what, std::vector<double> ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  std::printf("%-34s median %8.2f ms, 95 %% below %8.2f ms, %zu times\n", what, ms[ms.size() / 2],
              ms[ms.size() * 95 / 100], ms.size());
}

/// Looks along -z at the box, orthographically, 1000 pixels for twice its longest side.
Json front_camera(const Box& box) {
  double side = 0;
  for (int a = 0; a < 3; ++a) side = std::max(side, box.upper[a] - box.lower[a]);
  const auto middle = [&box](int a) { return (box.lower[a] + box.upper[a]) / 2; };
  return {{"view", {1, 0, 0, -middle(0), 0, 1, 0, -middle(1), 0, 0, 1, -box.upper[2] - side, 0, 0, 0, 1}},
          {"projection", {1 / side, 0, 0, 0, 0, 1 / side, 0, 0, 0, 0, -1 / (2 * side), -1, 0, 0, 0, 1}},
          {"width", 1000},
          {"height", 1000}};
}

/// Across a fifth of the body, at another height each time.
Json stroke(const Box& box, int turn) {
  const double y = 420 + 8 * (turn % 20);
  return {{"op", "guide"}, {"camera", front_camera(box)}, {"stroke", {{450, y}, {500, y + 6}, {550, y}}}};
}

bool is_mesh(const Json& message) { return message.value("event", "") == "mesh"; }

/// What one mesh took on its way: until it was announced, until its bytes were here, until it was decoded.
struct Way {
  double announced = 0, fetched = 0, decoded = 0;
};

Way fetch(Connection& connection, const Json& event, Clock::time_point start) {
  Way way;
  way.announced = ms_since(start);
  const std::vector<std::byte> blob = connection.get("/blob/" + event["blob"].dump());
  way.fetched = ms_since(start);
  decode_mesh(blob);
  way.decoded = ms_since(start);
  return way;
}

/// Medians and more of many ways.
class Ways {
 public:
  void add(const Way& way, const Json& event) {
    announced_.push_back(way.announced);
    fetched_.push_back(way.fetched - way.announced);
    decoded_.push_back(way.decoded - way.fetched);
    all_.push_back(way.decoded);
    encoded_.push_back(event["ms"].value("encode", 0.0));
  }

  void print(const char* what) const {
    print_times(what, all_);
    print_times("  until announced", announced_);
    print_times("    of it encoding", encoded_);
    print_times("  transfer", fetched_);
    print_times("  decoding", decoded_);
  }

 private:
  std::vector<double> announced_, fetched_, decoded_, all_, encoded_;
};

void measure_strokes(Connection& connection, const Box& box, int strokes) {
  Ways ways;
  std::vector<double> engine;
  for (int i = 0; i < strokes; ++i) {
    std::this_thread::sleep_for(kPause);
    const auto start = Clock::now();
    const int id = connection.send("apply", {{"operation", stroke(box, i)}});
    const Json mesh = connection.receive([](const Json& message) { return is_mesh(message) && !message["preview"]; });
    ways.add(fetch(connection, mesh, start), mesh);
    const Json reply = connection.receive([id](const Json& message) { return message.value("id", 0) == id; });
    engine.push_back(reply["record"]["total_ms"]);
    connection.ask("undo");
  }
  ways.print("stroke to decoded mesh");
  print_times("  the engine", engine);
}

Json bend(const Box& box, double degrees) {
  const double half = (box.upper[1] - box.lower[1]) / 2;
  const double x = (box.lower[0] + box.upper[0]) / 2;
  const double y = box.lower[1] + half;
  const double z = (box.lower[2] + box.upper[2]) / 2;
  const Json held = {{"region", {{"half_space", {{"point", {x, y - half / 2, z}}, {"normal", {0, -1, 0}}}}}}};
  Json turned = {{"region", {{"half_space", {{"point", {x, y + half / 2, z}}, {"normal", {0, 1, 0}}}}}}};
  turned["rigid"] = {{"axis", {0, 0, 1}}, {"point", {x, y, z}}, {"degrees", degrees}};
  return {{"op", "deform"}, {"handles", {held, turned}}};
}

/// As a page that is dragged: a request as soon as the mesh before is there.
void measure_bend(Connection& connection, const Box& box, int moves) {
  Ways ways;
  for (int i = 0; i < moves; ++i) {
    const auto start = Clock::now();
    connection.send("preview", {{"operation", bend(box, 60.0 * i / moves)}});
    const Json mesh = connection.receive([](const Json& message) { return is_mesh(message) && message["preview"]; });
    const Way way = fetch(connection, mesh, start);
    if (i > 2) ways.add(way, mesh);  // the first make the deformer
  }
  connection.ask("preview_end");
  ways.print("bend, mesh to mesh");
}

void measure_water(Connection& connection, int frames, int particles) {
  connection.ask("fluid", {{"start", {{"scene", "dam-break"}, {"particles", particles}, {"free", true}}}});
  const auto is_frame = [](const Json& message) { return message.value("event", "") == "frame"; };
  Ways ways;
  auto before = Clock::now();
  for (int i = 0; i < frames; ++i) {
    const Json frame = connection.receive(is_frame);
    const Way way = fetch(connection, frame, before);
    if (i > 10) ways.add(way, frame);
    before = Clock::now();
  }
  connection.ask("fluid", {{"stop", true}});
  ways.print("live water, frame to frame");
}

int number(int argc, char** argv, const std::string& name, int otherwise) {
  for (int i = 2; i + 1 < argc; ++i)
    if (argv[i] == name) return std::atoi(argv[i + 1]);
  return otherwise;
}

int run(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr,
                 "usage: pointskin_studio_latency URL [--strokes N] [--moves N] [--frames N] [--particles N]\n");
    return 2;
  }
  Connection connection(argv[1]);
  const Json state = connection.ask("hello");
  Box box{};
  const Json& bounds = state["scene"]["clouds"][0]["box"];
  for (int a = 0; a < 3; ++a) {
    box.lower[a] = bounds["lower"][a];
    box.upper[a] = bounds["upper"][a];
  }
  measure_strokes(connection, box, number(argc, argv, "--strokes", 20));
  measure_bend(connection, box, number(argc, argv, "--moves", 120));
  measure_water(connection, number(argc, argv, "--frames", 200), number(argc, argv, "--particles", 32768));
  return 0;
}

}  // namespace
}  // namespace pointskin::bench

int main(int argc, char** argv) {
  try {
    return pointskin::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pointskin_studio_latency: %s\n", error.what());
    return 1;
  }
}
