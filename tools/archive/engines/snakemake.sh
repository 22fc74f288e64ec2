# Snakemake on this computer; with --cluster or --profile in $LOOKOUT_SNAKEMAKE on others. What it knows of done jobs ends with this run.
cat >"$LOOKOUT_BATCHES/Snakefile" <<'SNAKEFILE'
import os
last = int(os.environ["LOOKOUT_LAST"])
rule all:
    input: expand("{batch}.ended", batch=range(last + 1))
rule work:
    input: "{batch}.jsonl"
    output: touch("{batch}.ended")
    shell: '"$LOOKOUT_ARCHIVE" work --archive "$LOOKOUT_FOLDER" --batch "$LOOKOUT_BATCHES"/{input}'
SNAKEFILE
# shellcheck disable=SC2086
snakemake --snakefile "$LOOKOUT_BATCHES/Snakefile" --directory "$LOOKOUT_BATCHES" --cores "$LOOKOUT_JOBS" --keep-going --nolock --quiet $LOOKOUT_SNAKEMAKE
