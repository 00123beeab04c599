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

std::string XdmfSeries::attribute(const Field& field) const {
  const char* const type = field.is_tensor ? "Tensor" : field.is_vector ? "Vector" : "Scalar";
  const char* const width = field.is_tensor ? " 9" : field.is_vector ? " 3" : "";
  return "<Attribute Name=\"" + escaped(field.name) + "\" AttributeType=\"" + type +
         "\" Center=\"Node\">" +
         data_item(field.is_flag ? flag_type : double_type, points_ + width,
                   escaped(field.dataset)) +
         "</Attribute>\n";
}

void XdmfSeries::add(int step, double load_factor, const std::string& mode,
                     const std::vector<Field>& fields) {
  // Readers of both generations (XDMF 2 and 3) understand explicit connectivity and three
  // components.
  grids_ += "<Grid Name=\"body\" GridType=\"Uniform\">\n<Time Value=\"" + std::to_string(step) +
            "\"/>\n<Information Name=\"load_factor\" Value=\"" + number_text(load_factor) +
            "\"/>\n<Information Name=\"mode\" Value=\"" + mode +
            "\"/>\n<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + points_ +
            "\" NodesPerElement=\"1\">" +
            data_item("NumberType=\"Int\" Precision=\"4\"", points_, "/points/number") +
            "</Topology>\n<Geometry GeometryType=\"XYZ\">" +
            data_item(double_type, points_ + " 3", "/points/geometry") + "</Geometry>\n";
  grids_ +=
      "<Attribute Name=\"load_factor\" AttributeType=\"Scalar\" Center=\"Grid\"><DataItem "
      "Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"1\">" +
      number_text(load_factor) + "</DataItem></Attribute>\n";
  for (const Field& field : fields) grids_ += attribute(field);
  for (const Field& field : constant_) grids_ += attribute(field);
  grids_ += "</Grid>\n";
}

std::string XdmfSeries::text() const {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
         "<Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         grids_ + "</Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace peristat
