# shellcheck shell=bash disable=SC2154,SC2012
# The part that all job scripts here share; they set launch and backend and source it. The first argument of the
# job is the options file, the others are options of mpm.
#
# Slurm sends SIGUSR1 to this shell before the time limit (--signal=B:), which hands it to the launcher, and that
# to the program, whatever launches it. The program then writes a checkpoint and ends with 75: the job is
# submitted again as it was. So it is when the program was killed (a status above 128), as long as there is a new
# checkpoint to go on from. 0: the run is done. 1 (the system), 2 (input) and 3 (computation) would come again, and
# end the chain.

deck=$1
shift
script=${MPM_SCRIPTS:-$SLURM_SUBMIT_DIR/scripts}/site/slurm/$script_name
program=${MPM:-$SLURM_SUBMIT_DIR/build/openmp/app/mpm}
folder=${MPM_OUTPUT:-out/$(basename "$deck" .opts)}

last_checkpoint() { ls -1 "$folder"/checkpoint_*.h5 2>/dev/null | sort -V | tail -1; }
# The next job is this script with this job's limits; options on the command line of the first sbatch are given
# in MPM_SBATCH_OPTIONS, too, since a job does not see them.
again() {
  # shellcheck disable=SC2086
  sbatch $MPM_SBATCH_OPTIONS "$script" "$deck" "$@"
}

from=$(last_checkpoint)
restart=()
if [ -n "$from" ]; then restart=(-restart latest); fi
# MPM_LAUNCH names another launcher, as "srun --mpi=pmix --cpu-bind=cores"; Debian's Open MPI has no support of srun.
${MPM_LAUNCH:-$launch} "$program" -options_file "$deck" -output_dir "$folder" -backend "$backend" "${restart[@]}" "$@" &
child=$!
signalled=yes
trap 'signalled=yes; kill -USR1 $child' USR1
while [ $signalled = yes ]; do  # a signal ends the wait, not the program
  signalled=no
  wait $child
  status=$?
done
to=$(last_checkpoint)
echo "job $SLURM_JOB_ID: exit status $status, from ${from:-the start} to ${to:-no checkpoint}"
case $status in
  0) exit 0 ;;
  75) ;;
  *)
    if [ "$status" -lt 128 ] || [ "$to" = "$from" ]; then exit "$status"; fi
    ;;
esac
again "$@"
