// Recognises the format of a mesh file and passes it to the reader or writer of that format.
#include "io/mesh_file.h"

#include <algorithm>
#include <array>
#include <limits>

#include "io/file_bytes.h"
#include "io/formats.h"

namespace prcage {
namespace {

struct FormatName {
  MeshFormat format;
  const char* name;
};

constexpr std::array<FormatName, 6> format_names{{
    {MeshFormat::ply_binary, "ply"},
    {MeshFormat::ply_ascii, "ply-ascii"},
    {MeshFormat::obj, "obj"},
    {MeshFormat::stl_binary, "stl"},
    {MeshFormat::stl_ascii, "stl-ascii"},
    {MeshFormat::off, "off"},
}};

constexpr std::string_view utf8_mark = "\xef\xbb\xbf";

// Files that people try, by their first bytes, and what helps.
struct ForeignFormat {
  std::string_view magic;
  const char* advice;
};

constexpr std::array<ForeignFormat, 5> foreign_formats{{
    {"\x1f\x8b", "it is compressed by gzip: unpack it first"},
    {"PK\x03\x04", "it is a zip archive (3MF is one): unpack or convert it first"},
    {"glTF", "it is glTF: convert it first"},
    {"<?xml", "it is XML: convert it first"},
    {"{", "it looks like JSON (glTF is): convert it first"},
}};

bool fail_unknown(std::string_view bytes, MeshFile& file) {
  std::string reason = stl_size_mismatch(bytes);
  for (const ForeignFormat& foreign : foreign_formats) {
    if (bytes.starts_with(foreign.magic)) reason = foreign.advice;
  }
  return fail(file, "no mesh format that is understood (PLY, OBJ, STL, OFF)" + (reason.empty() ? "" : "; " + reason));
}

// The size rule of binary STL comes before the words with which its arbitrary header may begin.
bool read_any(std::string_view bytes, MeshFile& file) {
  if (bytes.empty()) return fail(file, "the file is empty");
  if (looks_like_ply(bytes)) return read_ply(bytes, file);
  if (looks_like_stl_binary(bytes)) return read_stl_binary(bytes, file);
  if (looks_like_stl_ascii(bytes)) {
    return read_stl_ascii(bytes, file) || (bytes.find('\0') != std::string_view::npos && fail_unknown(bytes, file));
  }
  if (looks_like_off(bytes)) return read_off(bytes, file);
  if (looks_like_obj(bytes)) return read_obj(bytes, file);
  return fail_unknown(bytes, file);
}

// Triangles that name missing vertices, or more elements than the format counts, are never written.
std::string reason_not_to_write(const Mesh& mesh, MeshFormat format) {
  const std::size_t vertices = mesh.positions.size();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner >= vertices) {
        return "triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) + ", but there are only " +
               std::to_string(vertices);
      }
    }
  }
  const bool too_many = mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max();
  if (format == MeshFormat::stl_binary && too_many) return "too many triangles for binary STL";
  return {};
}

// A comment may not break the line that it is written into, nor continue it as a backslash at its end does in OBJ.
std::string one_line(std::string text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
  std::replace_if(text.begin(), text.end(), is_control, ' ');
  return text.ends_with('\\') ? text + " " : text;
}

void write_as(MeshFormat format, OutputFile& out, const Mesh& mesh, const std::string& comment) {
  switch (format) {
    case MeshFormat::ply_binary:
      return write_ply(out, mesh, true, comment);
    case MeshFormat::ply_ascii:
      return write_ply(out, mesh, false, comment);
    case MeshFormat::obj:
      return write_obj(out, mesh, comment);
    case MeshFormat::stl_binary:
      return write_stl_binary(out, mesh);
    case MeshFormat::stl_ascii:
      return write_stl_ascii(out, mesh);
    case MeshFormat::off:
      return write_off(out, mesh, comment);
  }
}

}  // namespace

const char* to_string(MeshFormat format) {
  for (const FormatName& entry : format_names) {
    if (entry.format == format) return entry.name;
  }
  return "unknown";
}

bool parse_mesh_format(const std::string& name, MeshFormat& format) {
  for (const FormatName& entry : format_names) {
    if (name != entry.name) continue;
    format = entry.format;
    return true;
  }
  return false;
}

bool mesh_format_of_path(const std::string& path, MeshFormat& format) {
  std::string extension = path.substr(std::min(path.rfind('.'), path.size()));
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  // Names with a hyphen are no extensions.
  const bool plain = extension.size() == 4;
  return plain && parse_mesh_format(extension.substr(1), format);
}

bool stores_floats(MeshFormat format) { return format == MeshFormat::stl_binary; }

MeshFile parse_mesh(std::string_view bytes) {
  if (bytes.starts_with(utf8_mark)) bytes.remove_prefix(utf8_mark.size());
  MeshFile file;
  file.ok = read_any(bytes, file);
  if (!file.ok) file.mesh = {};
  return file;
}

MeshFile read_mesh(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  const FileBytes contents(path);
  MeshFile file;
  if (contents.ok()) {
    file = parse_mesh(contents.bytes());
  } else {
    file.error = contents.error();
  }
  if (!file.ok) file.error = name + ": " + file.error;
  return file;
}

WriteResult write_mesh(const std::string& path, MeshFormat format, const Mesh& mesh, const std::string& comment) {
  const std::string reason = reason_not_to_write(mesh, format);
  if (!reason.empty()) return {false, path + ": not written: " + reason};
  OutputFile out(path);
  write_as(format, out, mesh, one_line(comment));
  return out.commit();
}

}  // namespace prcage
