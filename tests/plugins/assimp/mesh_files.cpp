#include "tests/plugins/assimp/mesh_files.h"

#include <zlib.h>

namespace weir::test {

namespace {

std::string deflated(const std::string& text) {
  z_stream stream{};
  // A raw stream, as zip archives have it.
  EXPECT_EQ(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace

std::string zipped(const std::vector<ZipMember>& members) {
  constexpr int kDeflate = 8;
  std::string file, directory;
  for (const ZipMember& member : members) {
    const std::string packed = deflated(member.text);
    const auto crc =
        crc32(0, reinterpret_cast<const Bytef*>(member.text.data()), static_cast<uInt>(member.text.size()));
    const std::string common = littleEndian(20, 2) + littleEndian(0, 2) + littleEndian(kDeflate, 2) +
                               littleEndian(0, 4) + littleEndian(crc, 4) + littleEndian(packed.size(), 4) +
                               littleEndian(member.text.size(), 4) + littleEndian(member.name.size(), 2) +
                               littleEndian(0, 2);
    directory += "PK\1\2" + littleEndian(20, 2) + common + littleEndian(0, 10) +
                 littleEndian(file.size(), 4) + member.name;
    file += "PK\3\4" + common + member.name + packed;
  }
  const std::string end = "PK\5\6" + littleEndian(0, 4) + littleEndian(members.size(), 2) +
                          littleEndian(members.size(), 2) + littleEndian(directory.size(), 4) +
                          littleEndian(file.size(), 4) + littleEndian(0, 2);
  return file + directory + end;
}

std::vector<ZipMember> threeMfBox(std::size_t blanks) {
  std::string model =
      R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources><object id="1" type="model"><mesh><vertices>)";
  for (int i = 0; i < 8; ++i) {
    const Vec3f v = corner(i);
    model += "<vertex x=\"" + std::to_string(v.x) + "\" y=\"" + std::to_string(v.y) + "\" z=\"" +
             std::to_string(v.z) + "\"/>";
  }
  model += "</vertices><triangles>";
  for (const auto& q : kQuads)
    for (const auto& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}})
      model += "<triangle v1=\"" + std::to_string(t[0]) + "\" v2=\"" + std::to_string(t[1]) + "\" v3=\"" +
               std::to_string(t[2]) + "\"/>";
  model += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
  model.append(blanks, ' ');
  return {{"[Content_Types].xml",
           R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
          {"_rels/.rels",
           R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>)"},
          {"3D/3dmodel.model", model}};
}

}  // namespace weir::test
