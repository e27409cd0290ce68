#include "output/frames.hpp"

#include <cstdio>

#include "common/collectives.hpp"
#include "output/files.hpp"
#include "output/frame_file.hpp"

namespace mpm {
namespace {

/// Name of a frame relative to the output folder.
std::string file_name(int number) {
  char file[40];
  std::snprintf(file, sizeof file, "frames/frame_%05d.h5", number);
  return file;
}

}  // namespace

PetscErrorCode write_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style) {
  PetscFunctionBeginUser;
  std::string image;
  PetscCall(frame_image(path, snapshot, precision, style, &image));
  PetscCall(replace_file(path, image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void Frames::open(const std::string& folder, Precision precision, const FrameStyle& style, MPI_Comm comm) {
  style_ = style;
  comm_ = comm;
  folder_ = folder;
  precision_ = precision;
  entries_.clear();
  count_ = 0;
}

PetscErrorCode Frames::resume(const Config& config, long count, MPI_Comm comm) {
  PetscFunctionBeginUser;
  open(config.output.directory, config.precision, {config.output.fields, config.output.compression}, comm);
  std::vector<std::string> names;
  for (const BodyConfig& body : config.bodies) names.push_back(body.name);
  for (const RigidConfig& rigid : config.rigids) names.push_back(rigid.name);
  const std::size_t always = names.size();
  names.push_back(k_nodes);
  for (const ContactPairConfig& pair : config.contact_pairs) names.push_back(pair.name);
  count_ = static_cast<int>(count);
  if (rank_of(comm_) == 0)
    for (int n = 0; n < count_; ++n)
      if (auto entry = read_entry(folder_, file_name(n), names, always))
        entries_.push_back(std::move(*entry));
  PetscCall(agree(comm_, entries_.empty() ? PETSC_SUCCESS : write_index()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::settle() const {
  PetscFunctionBeginUser;
  const bool due = count_ > 0 && rank_of(comm_) == 0;
  PetscCall(agree(comm_, due ? bring_to_disk(folder_ + "/frames") : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::write_index() const {
  PetscFunctionBeginUser;
  PetscCall(replace_file(folder_ + "/particles.xdmf",
                         format_xdmf(entries_, precision_ == Precision::single ? 4 : 8)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::write(const Snapshot& snapshot) {
  PetscFunctionBeginUser;
  const std::string file = file_name(count_);
  if (size_of(comm_) == 1)
    PetscCall(write_frame(folder_ + "/" + file, snapshot, precision_, style_));
  else
    PetscCall(write_frame_together(comm_, folder_ + "/" + file, snapshot, precision_, style_));

  FrameEntry entry{file, snapshot.time, {}};
  const auto add = [&](const std::vector<ParticleSnapshot>& groups, Framed kind) {
    for (const auto& group : groups)
      entry.groups.push_back(
          {group.name,
           group.total < 0 ? static_cast<long>(group.position.size() / 3) : group.total,
           written_fields(group, kind, style_),
           {static_cast<long>(group.vertices.size() / 3), static_cast<long>(group.triangles.size() / 3)}});
  };
  add(snapshot.bodies, Framed::bodies), add(snapshot.rigids, Framed::all), add(snapshot.nodes, Framed::nodes);
  add(snapshot.contacts, Framed::contacts);
  entries_.push_back(std::move(entry));
  ++count_;
  PetscCall(agree(comm_, rank_of(comm_) == 0 ? write_index() : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
