// What a client of a running studio waits for: strokes, a bend and live water, until their meshes are decoded.
//
//     pointskin_studio_latency URL [--strokes N] [--moves N] [--frames N] [--particles N]
//
// URL is the line that `pointskin studio CLOUD --no-browser` prints. Prints medians and 95th percentiles.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <string>
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

DrawnMesh fetch(Connection& connection, const Json& event) {
  const Json& id = event["blob"];
  return decode_mesh(connection.get("/blob/" + (id.is_string() ? id.get<std::string>() : id.dump())));
}

void measure_strokes(Connection& connection, const Box& box, int strokes) {
  std::vector<double> waited, engine;
  for (int i = 0; i < strokes; ++i) {
    const auto start = Clock::now();
    const int id = connection.send("apply", {{"operation", stroke(box, i)}});
    const Json mesh = connection.receive([](const Json& message) { return is_mesh(message) && !message["preview"]; });
    fetch(connection, mesh);
    waited.push_back(ms_since(start));
    const Json reply = connection.receive([id](const Json& message) { return message.value("id", 0) == id; });
    engine.push_back(reply["record"]["total_ms"]);
    connection.ask("undo");
  }
  print_times("stroke to decoded mesh", waited);
  print_times("  of it the engine", engine);
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
  std::vector<double> waited;
  for (int i = 0; i < moves; ++i) {
    const auto start = Clock::now();
    connection.send("preview", {{"operation", bend(box, 60.0 * i / moves)}});
    fetch(connection, connection.receive([](const Json& message) { return is_mesh(message) && message["preview"]; }));
    if (i > 2) waited.push_back(ms_since(start));  // the first make the deformer
  }
  connection.ask("preview_end");
  print_times("bend, mesh to mesh", waited);
}

void measure_water(Connection& connection, int frames, int particles) {
  connection.ask("fluid", {{"start", {{"scene", "dam-break"}, {"particles", particles}}}});
  const auto is_frame = [](const Json& message) { return message.value("event", "") == "frame"; };
  std::vector<double> waited;
  auto before = Clock::now();
  for (int i = 0; i < frames; ++i) {
    fetch(connection, connection.receive(is_frame));
    if (i > 10) waited.push_back(ms_since(before));
    before = Clock::now();
  }
  connection.ask("fluid", {{"stop", true}});
  print_times("live water, frame to frame", waited);
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
