# GNU parallel on this computer (or, with its own options in $PARALLEL, on others).
seq 0 "$LOOKOUT_LAST" | parallel --will-cite --jobs "$LOOKOUT_JOBS" --env LOOKOUT_ARCHIVE --env LOOKOUT_FOLDER --env LOOKOUT_BATCHES \
  '"$LOOKOUT_ARCHIVE" work --archive "$LOOKOUT_FOLDER" --batch "$LOOKOUT_BATCHES"/{}.jsonl'
