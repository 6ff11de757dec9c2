// 3MF: an archive with a mesh in XML. Source: 3MF Consortium, "3MF Core Specification" 1.3, and its "Materials and
// Properties Extension" 1.2 for colours.
#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/format.hpp"
#include "io/text_lines.hpp"
#include "io/writers.hpp"
#include "io/zip.hpp"

namespace pointskin::io {
namespace {

constexpr char kContentTypes[] =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr char kRelations[] =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
constexpr char kModel[] =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<metadata name="Application">pointskin</metadata>
<resources>
)";
constexpr int kObject = 1, kColours = 2;  ///< ids

/// True if every edge has one triangle on each side, as objects of the type "model" must have it.
bool is_closed(const std::vector<Triangle>& triangles) {
  std::vector<std::uint64_t> edges, turned;
  const auto edge = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b);
  };
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      edges.push_back(edge(t[i], t[(i + 1) % 3]));
      turned.push_back(edge(t[(i + 1) % 3], t[i]));
    }
  std::sort(edges.begin(), edges.end());
  std::sort(turned.begin(), turned.end());
  return edges == turned && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/// Colours that differ, and which of them each vertex has.
struct Palette {
  std::vector<std::uint32_t> colours;  ///< 0xRRGGBB
  std::vector<std::uint32_t> of;       ///< shape (n) or (0)
};

Palette palette_of(const Mesh& mesh) {
  Palette palette;
  const auto channels = colour_of(mesh);
  if (!channels) return palette;
  std::unordered_map<std::uint32_t, std::uint32_t> known;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    std::uint32_t colour = 0;
    for (const std::uint8_t* channel : *channels) colour = colour << 8 | channel[i];
    const auto [at, is_new] = known.try_emplace(colour, static_cast<std::uint32_t>(palette.colours.size()));
    if (is_new) palette.colours.push_back(colour);
    palette.of.push_back(at->second);
  }
  return palette;
}

std::string model_of(const Mesh& mesh) {
  std::string text = kModel;
  const auto out = std::back_inserter(text);
  const Palette palette = palette_of(mesh);
  if (!palette.of.empty()) {
    fmt::format_to(out, "<m:colorgroup id=\"{}\">\n", kColours);
    for (const std::uint32_t colour : palette.colours) fmt::format_to(out, "<m:color color=\"#{:06X}FF\"/>\n", colour);
    text += "</m:colorgroup>\n";
  }
  const char* const type = is_closed(mesh.triangles) ? "model" : "surface";
  fmt::format_to(out, "<object id=\"{}\" type=\"{}\"", kObject, type);
  if (!palette.of.empty()) fmt::format_to(out, " pid=\"{}\" pindex=\"0\"", kColours);
  text += "><mesh>\n<vertices>\n";
  for (const Vec3f& p : mesh.vertices) {
    if (is_zero(mesh.origin)) {
      fmt::format_to(out, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p.x, p.y, p.z);
    } else {
      const Vec3d w = world(mesh.origin, p);
      fmt::format_to(out, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", w.x, w.y, w.z);
    }
  }
  text += "</vertices>\n<triangles>\n";
  for (const Triangle& t : mesh.triangles) {
    fmt::format_to(out, "<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"", t[0], t[1], t[2]);
    if (!palette.of.empty()) {
      const auto colour = [&](std::size_t corner) { return palette.of[static_cast<std::size_t>(t[corner])]; };
      fmt::format_to(out, " p1=\"{}\" p2=\"{}\" p3=\"{}\"", colour(0), colour(1), colour(2));
    }
    text += "/>\n";
  }
  fmt::format_to(
      out, "</triangles>\n</mesh></object>\n</resources>\n<build><item objectid=\"{}\"/></build>\n</model>\n", kObject);
  return text;
}

}  // namespace

Blocks format_3mf(const Mesh& mesh, const WriteOptions& /*options*/) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::empty_result, "a 3MF file holds at least one triangle");
  return cut_into_blocks(
      zip({{"[Content_Types].xml", kContentTypes}, {"_rels/.rels", kRelations}, {"3D/3dmodel.model", model_of(mesh)}},
          true),
      {});
}

}  // namespace pointskin::io
