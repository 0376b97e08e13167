#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace partuv {

/// Why a call could not give a result. Errors of the data are returned, never thrown or printed.
enum class Error {
  empty_mesh,           ///< no faces
  index_out_of_range,   ///< a face names a vertex that does not exist
  non_finite_position,  ///< a referenced position is NaN or infinite
  no_face_with_area,    ///< every face is degenerate: nothing can be flattened
  invalid_option,       ///< an option is outside its range
  invalid_tree,         ///< a part tree or feature array that does not fit the mesh
  cancelled,            ///< `Context::cancel` was called
};

/// The wire name of an error, e.g. "non_finite_position".
const char* error_name(Error error);

/// An error and where it was found ("face 12", "option gutter_texels").
struct Failure {
  Error error;
  std::string where;
};

/// A value or the reason why there is none.
template <typename T>
class Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Failure failure) : state_(std::move(failure)) {}
  explicit operator bool() const { return std::holds_alternative<T>(state_); }
  T& value() { return std::get<T>(state_); }
  const T& value() const { return std::get<T>(state_); }
  const Failure& failure() const { return std::get<Failure>(state_); }

 private:
  std::variant<T, Failure> state_;
};

}  // namespace partuv
