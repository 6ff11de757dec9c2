#include "io/formats.hpp"

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include "io/las/header.hpp"
#include "io/libraries.hpp"
#include "io/npy.hpp"
#include "io/ply_header.hpp"
#include "io/readers.hpp"
#include "io/writers.hpp"

namespace pointskin {
namespace io {
namespace {

bool has_extension(const FormatInfo& format, const std::string& extension) {
  return std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end();
}

constexpr char kJson[] = "nlohmann-json";
constexpr char kMinizip[] = "minizip";
constexpr char kVtkXml[] = "pugixml, zlib";
constexpr char kPugixml[] = "pugixml";

FormatFunctions gltf_functions() {
  FormatFunctions run;
  if constexpr (kHasJson) {
    run.announces_faces = gltf_announces_faces;
    run.read_cloud = parse_gltf_cloud;
    run.read_mesh = parse_gltf_mesh;
  }
  return run;
}

FormatFunctions glb_functions() {
  FormatFunctions run = gltf_functions();
  if constexpr (kHasJson) {
    run.has_magic = is_glb;
    run.write_cloud = format_glb_cloud;
    run.write_mesh = format_glb_mesh;
  }
  return run;
}

FormatFunctions e57_functions() {
  FormatFunctions run;
  if constexpr (kHasPugixml) {
    run.has_magic = is_e57;
    run.read_cloud = parse_e57;
  }
  return run;
}

FormatFunctions npz_functions() {
  FormatFunctions run;
  if constexpr (kHasMinizip) {
    run.read_cloud = parse_npz_cloud;
    run.read_mesh = parse_npz_mesh;
    run.write_cloud = format_npz_cloud;
    run.write_mesh = format_npz_mesh;
  }
  return run;
}

FormatFunctions functions_of_3mf() {
  FormatFunctions run;
  if constexpr (kHasMinizip) run.write_mesh = format_3mf;
  return run;
}

FormatFunctions vtk_xml_functions(bool is_grid) {
  FormatFunctions run;
  if constexpr (kHasPugixml) {
    run.read_cloud = parse_vtk_xml_cloud;
    run.read_mesh = parse_vtk_xml_mesh;
    if (!is_grid) run.has_magic = is_vtk_xml;  // one reader for both
  }
  run.write_cloud = is_grid ? format_vtu_cloud : format_vtp_cloud;
  run.write_mesh = is_grid ? format_vtu_mesh : format_vtp_mesh;
  return run;
}

/// Lists name formats in the order of the table.
std::vector<Format> make_table() {
  using enum HeldAttributes;
  using enum NumberCoding;
  return {
      {{.name = "PLY",
        .extensions = {".ply"},
        .attributes = all,
        .coding = either,
        .read = "ascii, binary of both byte orders; every scalar property in its type; polygons of any length",
        .written = "binary or ascii; every attribute in its type; double coordinates where there is an origin",
        .tested_against = "Open3D"},
       {.has_magic = is_ply,
        .announces_faces = ply_announces_faces,
        .read_cloud = parse_ply_cloud,
        .read_mesh = parse_ply_mesh,
        .write_cloud = format_ply_cloud,
        .write_mesh = format_ply_mesh}},
      {{.name = "text",
        .extensions = {".xyz", ".pts", ".asc", ".txt", ".csv"},
        .read = "columns by their names, or 3, 4, 6, 7 or 9 of them; .xyz of bare floats, too, as splashsurf writes it",
        .tested_against = "numpy"},
       {.looks_like = [](std::string_view, bool) { return true; }, .read_cloud = parse_text}},
      {{.name = "VTK",
        .extensions = {".vtk"},
        .read =
            "legacy files up to 5.1, ascii and binary: points, normals, all point data; polygons, strips, and a grid's "
            "triangles, pixels and quads",
        .tested_against = "VTK"},
       {.has_magic = is_vtk, .read_cloud = parse_vtk_cloud, .read_mesh = parse_vtk_mesh}},
      {{.name = "JSON", .extensions = {".json"}, .read = "a list of [x, y, z], as splashsurf writes it"},
       {.looks_like = looks_like_json, .read_cloud = parse_json_points}},
      {{.name = "OBJ",
        .extensions = {".obj"},
        .attributes = colours,
        .coding = text,
        .read = "vertices with colours, normals, polygons",
        .written = "vertices with colours, normals, triangles",
        .tested_against = "Open3D"},
       {.looks_like = [](std::string_view, bool want_mesh) { return want_mesh; },
        .read_mesh = parse_obj,
        .write_mesh = format_obj}},
      {{.name = "STL",
        .extensions = {".stl"},
        .attributes = none,
        .coding = binary,
        .read = "binary and ascii; equal corners become one vertex",
        .written = "binary triangles",
        .tested_against = "Open3D"},
       {.looks_like = looks_like_stl, .read_mesh = parse_stl, .write_mesh = format_stl}},
      {{.name = "OFF",
        .extensions = {".off"},
        .attributes = colours,
        .coding = text,
        .read = "text: vertices, normals (NOFF), colours (COFF), polygons",
        .written = "text: vertices, normals, colours, triangles",
        .tested_against = "Open3D"},
       {.looks_like = looks_like_off, .read_mesh = parse_off, .write_mesh = format_off}},
      {{.name = "GLB",
        .extensions = {".glb"},
        .attributes = all,
        .coding = binary,
        .read = "all primitives of the scene where its nodes put them; normals, colours, attributes of applications",
        .written =
            "the origin as the node's translation; normals, colours, every attribute; 32-bit integers as floats; if "
            "asked for, quantised and compressed",
        .library = kJson,
        .tested_against = "Open3D, three.js",
        .built = kHasJson},
       glb_functions()},
      {{.name = "glTF",
        .extensions = {".gltf"},
        .read = "as GLB, with buffers as data: URIs or files in the same folder",
        .library = kJson,
        .tested_against = "Open3D",
        .built = kHasJson},
       gltf_functions()},
      {{.name = "VTP",
        .extensions = {".vtp"},
        .attributes = all,
        .coding = binary,
        .read = "VTK's XML of PolyData: all pieces, polygons and strips, all point data; text, base64 or appended, "
                "zlib or not",
        .written = "points or triangles, normals, every attribute in its type; appended, not compressed",
        .library = kVtkXml,
        .tested_against = "VTK",
        .built = kHasPugixml},
       vtk_xml_functions(false)},
      {{.name = "VTU",
        .extensions = {".vtu"},
        .attributes = all,
        .coding = binary,
        .read =
            "VTK's XML of UnstructuredGrid: its points, and its triangles, strips, polygons, pixels and quads; as VTP",
        .written = "as VTP",
        .library = kVtkXml,
        .tested_against = "VTK",
        .built = kHasPugixml},
       vtk_xml_functions(true)},
      {{.name = "3MF",
        .extensions = {".3mf"},
        .attributes = colours,
        .coding = text,
        .written = "vertices in millimetres, triangles, colours",
        .library = kMinizip,
        .tested_against = "Open3D",
        .built = kHasMinizip},
       functions_of_3mf()},
      {{.name = "LAS",
        .extensions = {".las", ".laz"},
        .read =
            "LAS 1.0 to 1.4 and LAZ, points of all formats: coordinates to the last digit of their scale, intensity, "
            "returns, classification, angle, time, colours, infrared, extra bytes",
        .tested_against = "LASzip"},
       {.has_magic = is_las, .read_cloud = parse_las}},
      {{.name = "PCD",
        .extensions = {".pcd"},
        .read = "ascii, binary, binary_compressed: all fields, packed colours as red, green and blue",
        .library = kHasLzf ? "liblzf" : "",
        .tested_against = "Open3D"},
       {.has_magic = is_pcd, .read_cloud = parse_pcd}},
      {{.name = "NPY",
        .extensions = {".npy"},
        .read = "an array of shape (n, 3), (n, 6) and so on as text has it, or a structured one",
        .tested_against = "numpy"},
       {.has_magic = is_npy, .read_cloud = parse_npy_cloud}},
      {{.name = "NPZ",
        .extensions = {".npz"},
        .attributes = all,
        .coding = binary,
        .read = "points or vertices, normals, rgb or colors, faces, every other array that is as long as the points",
        .written = "points, or vertices and faces; normals, rgb, every attribute in its type",
        .library = kMinizip,
        .tested_against = "numpy",
        .built = kHasMinizip},
       npz_functions()},
      {{.name = "BGEO",
        .extensions = {".bgeo"},
        .read = "version 5, packed by gzip or not: points with all float and integer attributes; N as normals, Cd as "
                "colours",
        .tested_against = "Partio"},
       {.has_magic = is_bgeo, .read_cloud = parse_bgeo}},
      {{.name = "BNPTS",
        .extensions = {".bnpts"},
        .read = "positions and normals as bare floats, as PoissonRecon has them",
        .tested_against = "numpy"},
       {.read_cloud = parse_bnpts}},
      {{.name = "PTX",
        .extensions = {".ptx"},
        .read = "points of all scans in world coordinates, intensity, colours, where the scanner stood",
        .tested_against = "CloudCompare"},
       {.read_cloud = parse_ptx}},
      {{.name = "E57",
        .extensions = {".e57"},
        .read = "points of all scans in world coordinates, normals, intensity, colours, all scalars, where the scanner "
                "stood",
        .library = kPugixml,
        .tested_against = "libE57Format",
        .built = kHasPugixml},
       e57_functions()},
  };
}

/// The first of `entries` that is what is looked for, or null.
template <class Entries, class Is>
auto* find(const Entries& entries, const Is& is) {
  const auto at = std::find_if(std::begin(entries), std::end(entries), is);
  return at == std::end(entries) ? nullptr : &*at;
}

const Format* find_magic(Formats table, std::string_view start) {
  return find(table, [&](const Format& f) { return f.run.has_magic != nullptr && f.run.has_magic(start); });
}

/// Null for no extension, too.
const Format* find_extension(Formats table, const std::string& extension) {
  return find(table, [&](const Format& f) { return has_extension(f.info, extension); });
}

/// For stdin and names without an extension.
const Format* guess(Formats table, std::string_view bytes, bool want_mesh) {
  const auto is = [&](const Format& f) {
    return f.run.looks_like != nullptr && (f.info.reads_meshes || !want_mesh) && f.run.looks_like(bytes, want_mesh);
  };
  const auto last = std::find_if(table.rbegin(), table.rend(), is);
  return last == table.rend() ? nullptr : &*last;
}

}  // namespace

Format::Format(FormatInfo about, const FormatFunctions& functions) : info(std::move(about)), run(functions) {
  if (!info.built) run = {};
  info.reads_meshes = run.read_mesh != nullptr;
  info.reads_clouds = run.read_cloud != nullptr || info.reads_meshes;
  info.writes_clouds = run.write_cloud != nullptr;
  info.writes_meshes = run.write_mesh != nullptr;
}

Formats formats() {
  static const std::vector<Format> table = make_table();
  return table;
}

std::vector<FormatInfo> infos_of(Formats table) {
  std::vector<FormatInfo> infos;
  for (const Format& format : table) infos.push_back(format.info);
  return infos;
}

const Format& read_format(const Source& source, bool want_mesh, Formats table) {
  const std::string extension = extension_of(source.name);
  const Format* format = find_magic(table, source.bytes);
  if (format == nullptr)
    format = extension.empty() ? guess(table, source.bytes, want_mesh) : find_extension(table, extension);
  if (format != nullptr && format->info.built && !format->info.reads_clouds)
    fail(source, "is " + format->info.name + ", which is written, but not read",
         "use " + extension_list(want_mesh ? &FormatInfo::reads_meshes : &FormatInfo::reads_clouds, infos_of(table)));
  if (format != nullptr && format->info.built) return *format;
  if (format != nullptr)
    fail(source, "is " + format->info.name + ", which this build was made without",
         "build it where " + format->info.library + " is installed");
  fail(source, "has the unknown extension " + in_quotes(extension),
       "use " + extension_list(want_mesh ? &FormatInfo::reads_meshes : &FormatInfo::reads_clouds, infos_of(table)));
}

Cloud parse_cloud(const Source& source, const ReadOptions& options, Formats table) {
  const Format& format = read_format(source, false, table);
  exec::Cpu ex(options.threads);
  if (format.run.read_cloud != nullptr) return format.run.read_cloud(ex, source, options);
  return cloud_of_vertices(format.run.read_mesh(ex, source, options));
}

Mesh parse_mesh(const Source& source, const ReadOptions& options, Formats table) {
  const Format& format = read_format(source, true, table);
  if (!format.info.reads_meshes)
    fail(source, "is a file of points, not a mesh",
         "name a " + extension_list(&FormatInfo::reads_meshes, infos_of(table)) + " file");
  exec::Cpu ex(options.threads);
  return format.run.read_mesh(ex, source, options);
}

bool may_hold_faces(const std::string& path, std::string_view start, Formats table) {
  const Format* format = find_magic(table, start);
  if (format == nullptr) format = find_extension(table, extension_of(path));
  if (format == nullptr || !format->info.reads_meshes) return false;
  return format->run.announces_faces == nullptr || format->run.announces_faces(start);
}

const Format& mesh_format(const std::string& path, Formats table) {
  const std::string extension = extension_of(path);
  if (path == "-" || (extension.empty() && is_stream(path))) return table.front();
  const Format* format = find_extension(table, extension);
  if (format != nullptr && format->info.writes_meshes) return *format;
  throw Error(ErrorCode::usage, printable(path) + ": unknown extension; use " +
                                    extension_list(&FormatInfo::writes_meshes, infos_of(table)));
}

const Format& cloud_format(const std::string& path, Formats table) {
  const Format* format = find_extension(table, extension_of(path));
  return format != nullptr && format->info.writes_clouds ? *format : table.front();
}

}  // namespace io

std::span<const FormatInfo> file_formats() {
  static const std::vector<FormatInfo> infos = io::infos_of(io::formats());
  return infos;
}

std::string extension_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t dot = path.rfind('.');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  if (dot == std::string::npos || dot <= name) return {};
  std::string extension = path.substr(dot);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

const FormatInfo* format_of(const std::string& path, std::span<const FormatInfo> formats) {
  const std::string extension = extension_of(path);
  return io::find(formats, [&](const FormatInfo& f) { return io::has_extension(f, extension); });
}

std::string extension_list(bool FormatInfo::*can, std::span<const FormatInfo> formats) {
  std::vector<std::string> words;
  for (const FormatInfo& format : formats)
    if (format.*can) words.insert(words.end(), format.extensions.begin(), format.extensions.end());
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i)
    list += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return list;
}

std::string format_names(bool FormatInfo::*can, std::span<const FormatInfo> formats) {
  std::string list;
  for (const FormatInfo& format : formats)
    if (format.*can) list += (list.empty() ? "" : ", ") + format.name;
  return list;
}

}  // namespace pointskin
