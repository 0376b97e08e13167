#!/bin/sh
# Makes what compose.yaml mounts as secrets, in docker/secrets (or the folder given). Prints the API
# key, once. Runs again only after the folder is removed: passwords in use are not overwritten.
set -eu
folder=${1:-$(dirname "$0")/secrets}
if [ -e "$folder/redis_users" ]; then
    echo "$folder is there already" >&2
    exit 1
fi
umask 022 # containers read them under their own user; the folder keeps others out
mkdir -p "$folder"
chmod 700 "$folder"

random() { head -c 32 /dev/urandom | base64 | tr -d '\n=' | tr '/+' '_-'; }
digest() { printf %s "$1" | sha256sum | cut -d' ' -f1; }

# Everything on our own keys and channels, nothing that rules the server; INFO tells its uptime.
rules='~partuv:* resetchannels &partuv:* +@all -@admin -@dangerous +info'
echo 'user default off' >"$folder/redis_users"
for name in gateway worker; do
    password=$(random)
    echo "user $name on #$(digest "$password") $rules" >>"$folder/redis_users"
    printf %s "redis://$name:$password@redis:6379/0" >"$folder/${name}_redis_url"
done
key=uv_live_$(random)
printf '{"default": "sha256:%s"}' "$(digest "$key")" >"$folder/partuv_api_keys"
printf '["whsec_%s"]' "$(head -c 32 /dev/urandom | base64 | tr -d '\n')" \
    >"$folder/partuv_webhook_secrets"
echo "API key, shown only now: $key"
