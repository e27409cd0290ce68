#include "output/performance_json.hpp"

#include "output/files.hpp"
#include "output/json.hpp"
#include "output/own_files.hpp"

namespace mpm {
namespace {

/// Members of an object, `indent` blanks from the left.
class Members {
 public:
  explicit Members(int indent) : indent_(indent, ' ') {}
  void text(const char* name, const std::string& value) { add(name, json_text(value)); }
  void number(const char* name, double value) { add(name, json_number(value)); }
  /// Adds a number that is 0 where it is unknown.
  void known(const char* name, double value) { add(name, value > 0 ? json_number(value) : "null"); }
  /// A value that is JSON already.
  void add(const char* name, const std::string& value) {
    text_ += (text_.empty() ? "\n" : ",\n") + indent_ + "\"" + name + "\": " + value;
  }
  std::string object() const { return "{" + text_ + "\n" + indent_.substr(2) + "}"; }

 private:
  std::string indent_, text_;
};

std::string json_of(const Spread& s) {
  return "{\"least\": " + json_number(s.least) + ", \"most\": " + json_number(s.most) +
         ", \"mean\": " + json_number(s.mean) + "}";
}

std::string json_of(const std::vector<FunctionTime>& functions) {
  std::string text;
  for (const FunctionTime& f : functions)
    text += (text.empty() ? "\n    " : ",\n    ") + ("{\"name\": " + json_text(f.name)) +
            ", \"calls\": " + std::to_string(f.calls) + ", \"seconds\": " + json_number(f.seconds) +
            ", \"bytes\": " + (f.bytes > 0 ? json_number(f.bytes) : "null") + "}";
  return text.empty() ? "[]" : "[" + text + "\n  ]";
}

std::string rebuilds_of(const Performance& p) {
  Members m(4);
  const bool any = p.rebuilds > 0;
  m.add("count", std::to_string(p.rebuilds));
  m.add("shortest_interval_steps", any ? std::to_string(p.shortest) : "null");
  m.add("longest_interval_steps", any ? std::to_string(p.longest) : "null");
  m.add("mean_interval_steps", any ? json_number(p.interval) : "null");
  return m.object();
}

std::string json_of(const RankFigures& r) {
  Members m(4);
  m.add("particles", json_of(r.particles));
  m.add("neighbours", json_of(r.neighbours));
  m.add("halo_nodes", json_of(r.halo_nodes));
  m.add("sent_bytes_per_step", json_of(r.sent));
  m.add("compute_seconds", json_of(r.compute));
  m.add("halo_seconds", json_of(r.halo));
  m.add("wait_seconds", json_of(r.wait));
  m.add("held_seconds", r.held ? json_of(*r.held) : "null");
  m.text("halo_path", r.halo_path);
  return m.object();
}

/// Adds the program and the machine.
void add_run(const Performance& p, Members* m) {
  m->text("program", "mpm");  // first: own_files.cpp recognises the file by it
  m->text("version", p.version);
  m->text("outcome", p.outcome);
  m->number("dim", p.dim);
  m->text("precision", p.precision);
  m->text("backend", p.backend);
  m->text("strategy", p.strategy);
  m->text("device", p.device);
  m->text("processor", p.processor);
  m->number("cores", p.cores);
  m->number("threads_per_rank", p.threads);
  m->number("ranks", p.ranks);
}

}  // namespace

std::string performance_json(const Performance& p) {
  Members m(2);
  add_run(p, &m);
  m.add("particles", std::to_string(p.particles));
  m.add("first_step", std::to_string(p.first_step));
  m.add("steps", std::to_string(p.steps));
  m.number("end_time_seconds", p.time);
  m.number("wall_seconds", p.wall);
  m.number("stepping_seconds", p.stepping);
  m.known("particle_updates_per_second", updates_per_second(p));
  m.known("real_time_factor", real_time_factor(p));
  m.add("energy_joules", p.energy ? json_number(*p.energy) : "null");
  m.add("gpu_energy_joules", p.gpu_energy ? json_number(*p.gpu_energy) : "null");
  m.known("memory_bytes", p.memory);
  m.known("copy_bandwidth_bytes_per_second", p.bandwidth);
  m.known("moved_bytes_per_second", moved_per_second(p));
  m.add("looks_of_host", std::to_string(p.looks));
  m.add("rebuilds", rebuilds_of(p));
  m.add("functions", json_of(functions_within_steps(p)));
  m.add("between_ranks", p.between_ranks ? json_of(*p.between_ranks) : "null");
  return m.object() + "\n";
}

PetscErrorCode write_performance_json(const std::string& folder, const Performance& p) {
  PetscFunctionBeginUser;
  PetscCall(replace_file(folder + "/performance.json", performance_json(p)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode forget_performance_json(const std::string& folder) {
  PetscFunctionBeginUser;
  int removed = 0;
  PetscCall(remove_own(folder + "/performance.json", &removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
