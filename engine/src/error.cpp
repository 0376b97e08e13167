#include "partuv/error.hpp"

namespace partuv {

const char* error_name(Error error) {
  switch (error) {
    case Error::empty_mesh:
      return "empty_mesh";
    case Error::index_out_of_range:
      return "index_out_of_range";
    case Error::non_finite_position:
      return "non_finite_position";
    case Error::no_face_with_area:
      return "no_face_with_area";
    case Error::invalid_option:
      return "invalid_option";
    case Error::invalid_tree:
      return "invalid_tree";
    case Error::cancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace partuv
