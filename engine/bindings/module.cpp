#include "bindings.hpp"

NB_MODULE(_core, m) {
  m.doc() = "Native core of partuv_engine";
  partuv::bind_context(m);
  partuv::bind_flatten(m);
  partuv::bind_mesh(m);
  partuv::bind_pack(m);
  partuv::bind_tree(m);
  partuv::bind_unwrap(m);
}
