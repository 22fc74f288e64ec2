# A job array of Slurm. Options for sbatch (partition, memory, time limit): $LOOKOUT_SBATCH.
# shellcheck disable=SC2086,SC2016
sbatch --wait --quiet --job-name lookout-archive --array "0-$LOOKOUT_LAST%$LOOKOUT_JOBS" --export ALL --output "$LOOKOUT_BATCHES/%a.said" $LOOKOUT_SBATCH \
  --wrap '"$LOOKOUT_ARCHIVE" work --archive "$LOOKOUT_FOLDER" --batch "$LOOKOUT_BATCHES/$SLURM_ARRAY_TASK_ID.jsonl"'
