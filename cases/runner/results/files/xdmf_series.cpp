#include "cases/runner/results/files/xdmf_series.hpp"

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

std::string data_item(const std::string& type, const std::string& dimensions,
                      const std::string& dataset) {
  return "<DataItem Format=\"HDF\" " + type + " Dimensions=\"" + dimensions +
         "\">results.h5:" + dataset + "</DataItem>";
}

constexpr const char* double_type = "NumberType=\"Float\" Precision=\"8\"";

constexpr const char* flag_type = "NumberType=\"UChar\" Precision=\"1\"";

/// Escapes a text for XML.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

std::string XdmfSeries::attribute(const Field& field, const std::string& centre) const {
  const char* const type = field.is_tensor ? "Tensor" : field.is_vector ? "Vector" : "Scalar";
  const char* const width = field.is_tensor ? " 9" : field.is_vector ? " 3" : "";
  return "<Attribute Name=\"" + escaped(field.name) + "\" AttributeType=\"" + type +
         "\" Center=\"" + centre + "\">" +
         data_item(field.is_flag ? flag_type : double_type, points_ + width,
                   escaped(field.dataset)) +
         "</Attribute>\n";
}

std::string XdmfSeries::body() const {
  // Readers of both generations (XDMF 2 and 3) understand explicit connectivity and three
  // components. Points and lines need their number of corners.
  std::string nodes;
  if (cells_.topology == "Polyvertex") nodes = " NodesPerElement=\"1\"";
  if (cells_.topology == "Polyline") nodes = " NodesPerElement=\"2\"";
  return "<Topology TopologyType=\"" + cells_.topology + "\" NumberOfElements=\"" + points_ + "\"" +
         nodes + ">" +
         data_item("NumberType=\"Int\" Precision=\"4\"", std::to_string(cells_.numbers),
                   cells_.dataset) +
         "</Topology>\n<Geometry GeometryType=\"XYZ\">" +
         data_item(double_type, std::to_string(cells_.corners) + " 3", "/points/cells/corners") +
         "</Geometry>\n";
}

std::string XdmfSeries::lines(const Lines& broken_bonds, const std::vector<Field>& fields) const {
  const std::string count = std::to_string(broken_bonds.count);
  constexpr const char* integer_type = "NumberType=\"Int\" Precision=\"8\"";
  std::string grid =
      "<Grid Name=\"broken_bonds\" GridType=\"Uniform\">\n<Topology TopologyType=\"Polyline\" "
      "NumberOfElements=\"" +
      count + "\" NodesPerElement=\"2\">" +
      data_item(integer_type, count + " 2", broken_bonds.group + "/bonds") +
      "</Topology>\n<Geometry GeometryType=\"XYZ\">" +
      data_item(double_type, points_ + " 3", "/points/geometry") +
      "</Geometry>\n<Attribute Name=\"step\" AttributeType=\"Scalar\" Center=\"Cell\">" +
      data_item(integer_type, count, broken_bonds.group + "/step") + "</Attribute>\n";
  for (const Field& field : fields) {
    if (field.name == "displacement") grid += attribute(field, "Node");
  }
  return grid + "</Grid>\n";
}

void XdmfSeries::add(int step, double load_factor, const std::string& mode,
                     const std::vector<Field>& fields, const Lines& broken_bonds) {
  grids_ +=
      "<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"" +
      std::to_string(step) + "\"/>\n<Information Name=\"load_factor\" Value=\"" +
      number_text(load_factor) + "\"/>\n<Information Name=\"mode\" Value=\"" + mode +
      "\"/>\n<Grid Name=\"body\" GridType=\"Uniform\">\n" + body();
  grids_ +=
      "<Attribute Name=\"load_factor\" AttributeType=\"Scalar\" Center=\"Grid\"><DataItem "
      "Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"1\">" +
      number_text(load_factor) + "</DataItem></Attribute>\n";
  for (const Field& field : fields) grids_ += attribute(field, "Cell");
  for (const Field& field : constant_) grids_ += attribute(field, "Cell");
  grids_ += "</Grid>\n";
  if (broken_bonds.count > 0) grids_ += lines(broken_bonds, fields);
  grids_ += "</Grid>\n";
}

std::string XdmfSeries::text() const {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
         "<Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         grids_ + "</Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace peristat
