// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <locale>
#include <ostream>
#include <sstream>
#include <string>

#include "files/file_formats.h"
#include "files/file_unit.h"
#include "files/pcd_fields.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// Number of values that a field has for each point.
int count_of(const Attribute& field) {
  return field.list_sizes.empty() ? 1 : field.list_sizes.front();
}

Attributes fields_of(const PointCloud& cloud, bool single_precision, const char* what) {
  Attributes fields;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Attribute field{std::string(1, "xyz"[axis]), {}, {}};
    const auto row = cloud.points.row(axis);
    if (single_precision)
      field.values = std::vector<float>(row.begin(), row.end());
    else
      field.values = std::vector<double>(row.begin(), row.end());
    fields.push_back(std::move(field));
  }
  for (Attribute& field : to_pcd_fields(cloud.attributes)) {
    if (find_attribute(fields, field.name) != nullptr || field.name == "_")
      throw InvalidInput(std::string(what) + ": an attribute is called \"" + field.name +
                         "\", which PCD needs itself or has already; give it another name");
    for (const int size : field.list_sizes)
      if (size != count_of(field))
        throw InvalidInput(std::string(what) + ": attribute \"" + field.name +
                           "\" has lists of several sizes; in PCD all are of one");
    fields.push_back(std::move(field));
  }
  return fields;
}

/// I, U or F. PCL stores a packed rgb as a float in binary files, and as a whole number in text.
char kind_of(const Attribute& field, bool text) {
  switch (type_of(field.values)) {
    case Scalar::int8:
    case Scalar::int16:
    case Scalar::int32:
    case Scalar::int64:
      return 'I';
    case Scalar::uint8:
    case Scalar::uint16:
    case Scalar::uint64:
      return 'U';
    case Scalar::uint32:
      return field.name == "rgb" && !text ? 'F' : 'U';
    case Scalar::float32:
    case Scalar::float64:
      break;
  }
  return 'F';
}

std::string header_of(const PointCloud& cloud, const Attributes& fields, bool text) {
  std::ostringstream header;
  header.imbue(std::locale::classic());
  header << "# .PCD v0.7 - Point Cloud Data file format\n# " << kUnitComment << "\n";
  for (const std::string& comment : cloud.comments) header << "# " << comment << "\n";
  header << "VERSION 0.7\nFIELDS";
  for (const Attribute& field : fields) header << ' ' << field.name;
  header << "\nSIZE";
  for (const Attribute& field : fields) header << ' ' << size_of(type_of(field.values));
  header << "\nTYPE";
  for (const Attribute& field : fields) header << ' ' << kind_of(field, text);
  header << "\nCOUNT";
  for (const Attribute& field : fields) header << ' ' << count_of(field);
  header << "\nWIDTH " << cloud.width << "\nHEIGHT " << cloud.height
         << "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << cloud.points.cols() << "\nDATA "
         << (text ? "ascii" : "binary") << "\n";
  return header.str();
}

}  // namespace

void write_pcd(std::ostream& stream, const PointCloud& cloud, const WriteOptions& options,
               const char* what) {
  const bool text = options.encoding == Encoding::text;
  const Attributes fields = fields_of(cloud, options.single_precision, what);
  std::string bytes = header_of(cloud, fields, text);
  for (Eigen::Index point = 0; point < cloud.points.cols(); ++point) {
    for (const Attribute& field : fields) {
      const auto count = static_cast<std::size_t>(count_of(field));
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t index = static_cast<std::size_t>(point) * count + k;
        if (text) {
          append_digits_of(bytes, field.values, index);
          bytes += ' ';
        } else {
          append_bytes_of(bytes, std::endian::little, field.values, index);
        }
      }
    }
    if (text) bytes.back() = '\n';
  }
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace palpate::geometry
