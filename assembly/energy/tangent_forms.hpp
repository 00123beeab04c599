#pragma once

namespace peristat {

class BlockTangent;
class RowVisits;
class RowOperator;
class ProductOperator;

/// The forms in which a tangent is available; null: not in this one.
struct TangentForms {
  BlockTangent* blocks = nullptr;
  RowVisits* visits = nullptr;
  RowOperator* rows = nullptr;
  ProductOperator* products = nullptr;
};

}  // namespace peristat
